"""The workbench: parameters, looks at a frame under others, sweeps, presets, bundles."""
