"""What all of HTTP shares: errors, security, resumable uploads."""
