"""Simulated experiments: what does a pad do, measured against a truth that is known?"""
