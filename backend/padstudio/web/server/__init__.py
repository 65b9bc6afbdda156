"""What the running server holds: settings, services, and the orders of work under way."""
