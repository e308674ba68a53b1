"""Swarms on a GPU: one warp for each, by numba-cuda; `simulation.DeviceSimulation` is what others use.

The modules import numba-cuda and torch, which the extra `gpu` installs, so that nothing but the option
`device="cuda"` imports them.
"""
