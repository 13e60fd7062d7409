"""Effects of sensors and commands that the file format does not have."""

from make_effects import Effect, any_of, general


def reading_scale(joint, drive, sign):
    """Readings larger by a share, in the loop of a servo too."""
    def apply(truth, size):
        truth.scales[joint] = sign * size
        if drive:
            own = general(truth, drive)
            bias = [float(word) * (1 + sign * size) for word in own.get("biasprm").split()]
            own.set("biasprm", " ".join(f"{value:.7g}" for value in bias))

    return Effect(f"sensor_scale@{joint}", apply, 0.02, 0.1, any_of(f"sensor_scale@({joint}|{joint}_pos)"), [], "relative", mjcf=False)


def reading_delay(joint):
    """Readings that are late in the recording."""
    def apply(truth, size):
        truth.lags[joint] = size

    return Effect(f"sensor_delay@{joint}", apply, 0.005, 0.04, any_of(f"sensor_delay@({joint}|{joint}_(pos|vel|eff))", also=[f"sensor_delay@{joint}_vel"]), [], "s", mjcf=False)


def dead_zone(drive, guess, limit):
    """Commands below a width do nothing."""
    def apply(truth, size):
        truth.zones[drive] = size

    return Effect(f"actuator_dead_zone@{drive}", apply, guess, limit, any_of(f"actuator_dead_zone@{drive}"), [], "command", mjcf=False)
