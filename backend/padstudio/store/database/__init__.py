"""Tables, the engine behind them, and the data folder that they describe."""
