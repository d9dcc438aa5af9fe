"""Joints of small studies, coarse lap joints with one bolt, and what load cases do to them."""

SMALL_JOINT = """
[model]
source = "lap-joint"
lap_joint = { element_size = 5.0 }

[[bolt]]
name = "bolt"
preload = 5e3

[damping]
beta = 1e-6
"""

TINY_JOINT = """
[model]
source = "lap-joint"
lap_joint = { element_size = 10.0, hole_radius = 0.0, washer_radius = 11.0 }

[[bolt]]
name = "bolt"
preload = 5e3
"""

NO_REPORT = "[output]\nreport = false\n"

UNCHECKED = "[validation]\nhalf_step = false\n"


def tiny_joint(keys="", preload="5e3"):
    """Return TINY_JOINT with keys of its interface and another preload."""
    return TINY_JOINT.replace("5e3", preload) + f'[[interface]]\nname = "joint"\n{keys}\n'


def reduction(*methods, normal_modes=4, joint_modes=None):
    """Return [reduction] with some methods."""
    counts = "" if joint_modes is None else f"joint_modes = {joint_modes}\n"
    named = ", ".join(f'"{name}"' for name in methods)
    return f"[reduction]\nnormal_modes = {normal_modes}\n{counts}methods = [{named}]\n"


def training(levels):
    """Return [reduction.training] with bending of the tip."""
    box = '[{ boundary = "tip", component = "Fz", min = -200.0, max = 200.0 }]'
    return f"[reduction.training]\nbox = {box}\nlevels = {levels}\nsteps_per_period = 20\n"


def static(name, component, value):
    """Return a static load case of the tip."""
    return _case(name, "static", component, value)


def step(name, component, value, timing="periods = 0.5\nsteps_per_period = 20\n"):
    """Return a step of the load of the tip."""
    return _case(name, "step", component, value, timing)


def _case(name, kind, component, value, timing=""):
    force = f'{{ boundary = "tip", component = "{component}", value = {value} }}'
    return f'[[load_case]]\nname = "{name}"\nkind = "{kind}"\n{timing}forces = [{force}]\n'


BEND = static("bend", "Fz", -150.0)
PULL = static("pull", "Fx", 900.0)
JUMP = step("jump", "Fz", -150.0)
FINE_JUMP = JUMP.replace("20", "40")
