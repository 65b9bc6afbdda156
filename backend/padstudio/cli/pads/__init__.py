"""Commands that make, check and amend pad files, one module each."""
