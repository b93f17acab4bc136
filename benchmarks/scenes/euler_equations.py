"""A rigid body about a fixed point, or about its centre of mass, as seven equations of first order."""


def euler_slopes(moments, lever, state):
    """Of the angular velocity in principal axes and of the quaternion, for any numbers: Euler's equations (7.48).

    `lever`: weight times the centre of mass in body axes [N m], under gravity along -z; None: no weight.
    """
    i1, i2, i3 = moments
    w1, w2, w3, a, b, c, d = state
    m1 = m2 = m3 = 0.0
    if lever is not None:
        x, y, z = lever
        u1, u2, u3 = 2.0 * (b * d - a * c), 2.0 * (c * d + a * b), a * a - b * b - c * c + d * d
        m1, m2, m3 = z * u2 - y * u3, x * u3 - z * u1, y * u1 - x * u2
    return [
        ((i2 - i3) * w2 * w3 + m1) / i1,
        ((i3 - i1) * w3 * w1 + m2) / i2,
        ((i1 - i2) * w1 * w2 + m3) / i3,
        -0.5 * (b * w1 + c * w2 + d * w3),
        0.5 * (a * w1 + c * w3 - d * w2),
        0.5 * (a * w2 + d * w1 - b * w3),
        0.5 * (a * w3 + b * w2 - c * w1),
    ]
