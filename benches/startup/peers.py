#!/usr/bin/env python3
"""What peers need until the same robots are evaluated or move: loads robot.xml and computes once.

    python3 peers.py mujoco|pinocchio rates|slopes|simulate
"""

import sys

import numpy as np


def mujoco(what):
    import mujoco as mj

    model = mj.MjModel.from_xml_path("robot.xml")
    data = mj.MjData(model)
    data.qvel[:] = 0.1
    if what == "simulate":
        mj.mj_step(model, data)
        return
    mj.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mj.mj_fullM(model, data, mass)
    if what == "slopes":
        size = 2 * model.nv
        mj.mjd_transitionFD(model, data, 1e-6, False, np.zeros((size, size)), None, None, None)


def pinocchio(what):
    import pinocchio as pin

    model = pin.buildModelFromMJCF("robot.xml")
    data = model.createData()
    q, v, tau = pin.neutral(model), np.full(model.nv, 0.1), np.zeros(model.nv)
    acceleration = pin.aba(model, data, q, v, tau)
    if what == "simulate":
        pin.integrate(model, q, (v + 0.001 * acceleration) * 0.001)
        return
    pin.crba(model, data, q)
    if what == "slopes":
        pin.computeABADerivatives(model, data, q, v, tau)


if __name__ == "__main__":
    {"mujoco": mujoco, "pinocchio": pinocchio}[sys.argv[1]](sys.argv[2])
