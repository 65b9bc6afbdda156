"""What the forms of camera files share: text to plain values, numbers, keys, lens names."""
