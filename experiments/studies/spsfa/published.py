"""Numbers printed in the SPSFA paper, for comparison with ours.

Source: J. Li, H. Fan, Y. Hou, IEEE Access 8 (2020), doi 10.1109/ACCESS.2020.3023999: tables 3, 6, 10 (final
fitness over 20 runs) and 4, 7, 11 (running time in seconds, MATLAB on a 2.1 GHz laptop); tables 12 and 13
(mean running time of SPSFA-TIP on case 3 by omega and by eta).
"""

from typing import NamedTuple


class PublishedSample(NamedTuple):
    """A row of a table of the SPSFA paper: one controller on one case, over 20 runs."""

    maximum: float
    minimum: float
    mean: float
    deviation: float


FITNESS_TABLES = {"case1": 3, "case2": 6, "case3": 10}
TIME_TABLES = {"case1": 4, "case2": 7, "case3": 11}

FITNESS: dict[tuple[str, str], PublishedSample] = {
    ("case1", "fixed:60"): PublishedSample(442.6158, 303.0075, 316.0910, 29.4427),
    ("case1", "fixed:80"): PublishedSample(442.5918, 305.0318, 318.0346, 29.4368),
    ("case1", "fixed:100"): PublishedSample(311.4962, 305.0269, 306.6842, 1.7087),
    ("case1", "spsfa"): PublishedSample(311.6977, 305.1202, 307.2759, 1.8688),
    ("case1", "spsfa-tip"): PublishedSample(311.5351, 305.0436, 307.1524, 1.9107),
    ("case2", "fixed:60"): PublishedSample(363.4167, 326.3189, 343.7111, 10.2863),
    ("case2", "fixed:80"): PublishedSample(381.7140, 326.2476, 337.2823, 11.7255),
    ("case2", "fixed:100"): PublishedSample(357.0749, 326.1359, 336.3130, 7.8811),
    ("case2", "spsfa"): PublishedSample(344.3411, 326.2554, 334.1019, 5.7965),
    ("case2", "spsfa-tip"): PublishedSample(343.7910, 326.2723, 333.8889, 5.5564),
    ("case3", "fixed:60"): PublishedSample(377.8497, 301.0494, 323.8432, 21.5089),
    ("case3", "fixed:80"): PublishedSample(368.1436, 300.9645, 319.7457, 22.8871),
    ("case3", "fixed:100"): PublishedSample(371.5501, 300.9717, 320.5980, 22.4212),
    ("case3", "spsfa"): PublishedSample(341.3666, 301.0223, 306.4953, 9.2023),
    ("case3", "spsfa-tip"): PublishedSample(331.3199, 300.9588, 305.4635, 7.9265),
}

SECONDS: dict[tuple[str, str], PublishedSample] = {
    ("case1", "fixed:60"): PublishedSample(171.6168, 158.3337, 164.6528, 4.8313),
    ("case1", "fixed:80"): PublishedSample(308.4826, 281.5166, 292.4876, 10.4160),
    ("case1", "fixed:100"): PublishedSample(476.8535, 442.4749, 458.6832, 13.5196),
    ("case1", "spsfa"): PublishedSample(195.8751, 106.4820, 146.4548, 25.1090),
    ("case1", "spsfa-tip"): PublishedSample(248.9887, 132.2167, 177.1657, 35.0899),
    ("case2", "fixed:60"): PublishedSample(185.7692, 168.3544, 175.9578, 6.3928),
    ("case2", "fixed:80"): PublishedSample(330.6995, 299.2875, 312.2085, 10.8351),
    ("case2", "fixed:100"): PublishedSample(514.4831, 468.5175, 486.6934, 14.7624),
    ("case2", "spsfa"): PublishedSample(285.3812, 138.6407, 220.1808, 48.9066),
    ("case2", "spsfa-tip"): PublishedSample(348.4017, 144.7955, 233.4750, 71.1037),
    ("case3", "fixed:60"): PublishedSample(183.1546, 167.5562, 174.5719, 6.0650),
    ("case3", "fixed:80"): PublishedSample(325.2651, 297.2246, 310.9700, 10.4816),
    ("case3", "fixed:100"): PublishedSample(503.5106, 466.3409, 483.0614, 14.9578),
    ("case3", "spsfa"): PublishedSample(261.0559, 118.6097, 172.2112, 41.2675),
    ("case3", "spsfa-tip"): PublishedSample(308.1163, 125.6084, 205.5591, 50.8039),
}

# Numbers of the figures of the SPSFA paper by the names of ours; figures of other scenarios have none.
FIGURE_NUMBERS = {
    "population-snapshots": 3,
    "population-collision": 4,
    "convergence-case1": 8,
    "population-size-case1": 9,
    "best-paths-case1": 10,
    "box-plots-case1": 11,
    "convergence-case2": 12,
    "population-size-case2": 13,
    "best-paths-case2": 14,
    "box-plots-case2": 15,
    "convergence-case3": 16,
    "population-size-case3": 17,
    "best-paths-case3": 18,
    "box-plots-case3": 19,
}

# Mean running time in seconds, by parameter of the schedule and its value.
PARAMETER_SECONDS: dict[str, dict[float, float]] = {
    "growth": {
        500.0: 204.7044,
        750.0: 227.5110,
        1000.0: 283.8155,
        1250.0: 250.3793,
        1500.0: 191.6361,
        1750.0: 199.3538,
        2000.0: 438.0723,
        2250.0: 532.4390,
    },
    "decay": {
        0.1: 807.7688,
        0.2: 288.9072,
        0.3: 94.4276,
        0.4: 66.5299,
        0.5: 61.6417,
        0.6: 65.5006,
        0.7: 61.2663,
        0.8: 51.2536,
        0.9: 60.4777,
    },
}
