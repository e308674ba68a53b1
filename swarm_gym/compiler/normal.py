"""Normally distributed numbers that have the same bits on every processor.

Source: M. J. Wichura, "Algorithm AS 241: the percentage points of the normal distribution", Applied
Statistics 37(3), 1988, routine PPND16. It gives one normal number for one uniform number.
"""

import math

import numpy as np
from numpy.typing import NDArray

from swarm_gym.compiler.elementary import logarithm
from swarm_gym.compiler.jit import kernel
from swarm_gym.compiler.random_stream import fill_uniform

Floats = NDArray[np.float64]

# The smallest share: a uniform number is a multiple of 2^-53, and may be 0.
_LEAST_SHARE = 2.0**-54
# Half the width of the middle of the distribution, and the last number before the far tail.
_MIDDLE, _NEAR_TAIL = 0.425, 5.0


@kernel
def normal_quantile(share: float) -> float:
    """Return the number below which this share, in (0, 1), of the standard normal distribution lies."""
    q = share - 0.5
    if abs(q) <= _MIDDLE:
        r = _MIDDLE * _MIDDLE - q * q
        above = 2.5090809287301226727e3 * r + 3.3430575583588128105e4
        above = (above * r + 6.7265770927008700853e4) * r + 4.5921953931549871457e4
        above = (above * r + 1.3731693765509461125e4) * r + 1.9715909503065514427e3
        above = (above * r + 1.3314166789178437745e2) * r + 3.3871328727963666080e0
        below = 5.2264952788528545610e3 * r + 2.8729085735721942674e4
        below = (below * r + 3.9307895800092710610e4) * r + 2.1213794301586595867e4
        below = (below * r + 5.3941960214247511077e3) * r + 6.8718700749205790830e2
        below = (below * r + 4.2313330701600911252e1) * r + 1.0
        return q * above / below
    r = math.sqrt(-logarithm(share if q <= 0.0 else 1.0 - share))
    if r <= _NEAR_TAIL:
        r -= 1.6
        above = 7.74545014278341407640e-4 * r + 2.27238449892691845833e-2
        above = (above * r + 2.41780725177450611770e-1) * r + 1.27045825245236838258e0
        above = (above * r + 3.64784832476320460504e0) * r + 5.76949722146069140550e0
        above = (above * r + 4.63033784615654529590e0) * r + 1.42343711074968357734e0
        below = 1.05075007164441684324e-9 * r + 5.47593808499534494600e-4
        below = (below * r + 1.51986665636164571966e-2) * r + 1.48103976427480074590e-1
        below = (below * r + 6.89767334985100004550e-1) * r + 1.67638483018380384940e0
        below = (below * r + 2.05319162663775882187e0) * r + 1.0
    else:
        r -= 5.0
        above = 2.01033439929228813265e-7 * r + 2.71155556874348757815e-5
        above = (above * r + 1.24266094738807843860e-3) * r + 2.65321895265761230930e-2
        above = (above * r + 2.96560571828504891230e-1) * r + 1.78482653991729133580e0
        above = (above * r + 5.46378491116411436990e0) * r + 6.65790464350110377720e0
        below = 2.04426310338993978564e-15 * r + 1.42151175831644588870e-7
        below = (below * r + 1.84631831751005468180e-5) * r + 7.86869131145613259100e-4
        below = (below * r + 1.48753612908506148525e-2) * r + 1.36929880922735805310e-1
        below = (below * r + 5.99832206555887937690e-1) * r + 1.0
    return above / below if q > 0.0 else -above / below


@kernel(borrows=True)
def fill_normal(stream: NDArray[np.uint64], out: Floats, count: int) -> None:
    """Fill `out` as `fill_uniform` does, then make the first `count` numbers standard normal ones."""
    fill_uniform(stream, out)
    for k in range(count):
        out[k] = normal_quantile(max(out[k], _LEAST_SHARE))
