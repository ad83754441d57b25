"""The parts of scripts/mutants.py, the mutation campaign for the shaders."""
