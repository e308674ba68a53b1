"""Published mean evaluations of the (1 + (lambda, lambda)) genetic algorithm on OneMax, 1,000 runs each.

Source: T. Nguyen, P. Le, C. Doerr, N. Dang, "Multi-parameter control for the (1+(lambda,lambda))-GA on OneMax
via deep reinforcement learning", FOGA 2025, arXiv 2505.12982: the runs and the table of its code,
github.com/taindp98/OneMax-MPDAC. Each entry is the mean and the standard deviation.
"""

Mean = tuple[float, float]

THEORY: dict[int, Mean] = {
    100: (582.624, 118.51),
    200: (1233.381, 193.11),
    500: (3237.161, 336.09),
    1000: (6587.452, 530.32),
    2000: (13361.918, 777.03),
}
ONE_FIFTH: dict[int, Mean] = {
    100: (619.724, 129.45),
    200: (1308.223, 217.61),
    500: (3371.872, 351.06),
    1000: (6886.090, 544.46),
    2000: (14016.436, 830.14),
}
IRACE: dict[int, Mean] = {
    100: (499.048, 86.38),
    200: (1043.198, 137.78),
    500: (2738.945, 231.34),
    1000: (5586.548, 353.15),
    2000: (11332.382, 510.54),
}
DDQN_LAMBDA: dict[int, Mean] = {
    100: (544.210, 122.64),
    200: (1142.246, 191.62),
    500: (3008.306, 315.77),
    1000: (6337.662, 547.03),
    2000: (13216.518, 812.35),
}
DDQN_FOUR: dict[int, Mean] = {
    100: (431.822, 83.19),
    200: (896.654, 129.53),
    500: (2407.196, 212.31),
    1000: (5396.899, 410.87),
    2000: (10324.969, 575.38),
}
NUM_RUNS = 1000
