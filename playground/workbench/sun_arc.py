"""Report a sun that is drawn elsewhere than it is set: an arc of its own is set, and the sun is not on it."""

from __future__ import annotations

from playground.engine.plan import Plan

_NEAR = 0.01  # [degrees] that count as on the arc


def sun_off_arc(plan: Plan) -> str:
    """Return a sentence for the first direction of a plan that is not on the arc set for it; else nothing.

    An arc goes through the zenith, from its azimuth to the opposite one.
    """
    for step in plan.walk():
        for parameter in step.kernel.parameters:
            rule = parameter.follows
            if rule is None:
                continue
            menu = step.kernel.parameter(rule.menu)
            if menu is not None and step.values[rule.menu] != menu.widget.given(rule.choice):
                continue
            if any(source is not None for name, source in step.inputs if name == "daylight"):
                continue  # the sun is that of the daylight
            arc, direction = step.values[parameter.name], step.values[rule.direction]
            assert isinstance(arc, int | float) and isinstance(direction, tuple)
            away = abs((arc - direction[0] + 90.0) % 180.0 - 90.0)
            if away > _NEAR and direction[1] < 90.0:
                pass_name = step.path.partition(".")[0]
                return (
                    f"{pass_name}.{rule.direction} is at azimuth {direction[0]:g}°, off its arc at {arc:g}°:"
                    f" it is drawn on the arc; reset {parameter.name} to have the arc follow it"
                )
    return ""
