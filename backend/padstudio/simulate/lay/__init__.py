"""How a print lies on the ground: bent paper, and sheets laid side by side."""
