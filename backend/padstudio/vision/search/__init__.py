"""The search for a lattice where no earlier pose helps."""
