"""What scripts/peers/nvdiffrast.py is made of: scenes and cameras, the rules of the CUDA rasterizer inside nvdiffrast written anew in
numpy from its source, and the explanation of every pixel on which it and rasterlab differ."""
