"""What requests and answers of experiments look like: one module a kind, beside what all share."""
