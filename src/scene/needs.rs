//! What a scene, seen from here, requires of the kernels: the planner leaves out whatever is not needed.
