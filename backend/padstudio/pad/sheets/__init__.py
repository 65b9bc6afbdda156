"""How a pad is laid on paper: papers, seams, tiling, and the strip that measures a printer."""
