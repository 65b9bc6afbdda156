"""Workers of flights, on this machine or on many, by Dask, which nothing else imports."""
