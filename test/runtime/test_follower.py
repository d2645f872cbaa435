# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Transitions and the follower: nothing jumps, limits hold, whatever is commanded and when."""

from dataclasses import replace
import math

from cam_motion.motion.limits import Limits
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.runtime.demand import Demand
from cam_motion.runtime.follower import Follower
from cam_motion.runtime.follower_settings import FollowerSettings, FollowerState
from cam_motion.runtime.layout import Coupling, Layout
from cam_motion.runtime.motion_over_angle import CoupledCam, Standstill, Superposition
from cam_motion.runtime.planning import At, Timing, TransitionError
from cam_motion.runtime.ramp import RampLimits
from cam_motion.runtime.shaft import Shaft, ShaftError
from cam_motion.runtime.shaft_motion import ShaftState
from cam_motion.runtime.speed_blend import SpeedBlend
from cam_motion.runtime.transition import Blend
from cam_motion.units import DEGREE, RPM, TURN
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

RAMP = RampLimits(30.0, 300.0)
TICK = 0.002
ROUNDING = 1e-9

PRESS = CamProfile([
    segment('wait', end_deg=60.0), segment('down', end_deg=150.0, lift=0.05, law='cycloidal'),
    segment('hold', end_deg=200.0),
    segment('up', end_deg=320.0, lift=-0.05, law='modified_trapezoid'),
    segment('rest', end_deg=360.0)])
SMALL = CamProfile([
    segment('down', end_deg=180.0, lift=0.02, law='modified_trapezoid'),
    segment('up', end_deg=360.0, lift=-0.02, law='cycloidal')])
BELT = CamProfile([
    segment('feed', end_deg=120.0, lift=0.3, law='modified_trapezoid'),
    segment('wait', end_deg=360.0)], accumulate=True)
SHORT_BELT = CamProfile([
    segment('feed', end_deg=150.0, lift=0.2, law='cycloidal'),
    segment('wait', end_deg=360.0)], accumulate=True)


def layout_of(*cams, active=('one',), **coupling):
    """Make a layout of cams named one, two, with one coupling for all."""
    names = ('one', 'two')[:len(cams)]
    return Layout(dict(zip(names, cams)),
                  {name: Coupling(**coupling) for name in names}, active)


def derivatives_fit(motion, low, high, jumps=()):
    """Check each derivative against differences of the one below, away from joints."""
    h = 1e-5
    phi = np.linspace(low, high, 801)
    joints = motion.joints(low - 1.0, high + 1.0)
    if joints.size:
        phi = phi[np.min(np.abs(phi[:, None] - joints), axis=1) > 3 * h]
    here = motion(phi)
    ahead, behind = motion(phi + h), motion(phi - h)
    for order in (1, 2, 3):
        slope = (ahead[order - 1] - behind[order - 1]) / (2.0 * h)
        scale = np.max(np.abs(here[order])) + 1e-12
        assert np.max(np.abs(slope - here[order])) <= 1e-5 * scale
    scalar = np.array([motion.sample(float(x)) for x in phi[::40]]).T
    assert np.allclose(scalar, here[:, ::40], rtol=1e-12, atol=1e-12)


class TestMotions:
    """Motions over the shaft angle."""

    def test_derivatives_fit_each_other(self):
        """Every motion is the integral of its derivatives, scalar and vectorised alike."""
        coupled = CoupledCam(PRESS, ratio=-1.5, phase=0.4, scale=0.7, offset=0.1)
        belt = CoupledCam(BELT, ratio=2.0, scale=-1.0)
        blend = Blend(coupled, belt, 2.0, 1.3)
        back = Blend(blend, Standstill(0.3), 2.5, -1.7)
        ways = [SpeedBlend(old, new, 2.0, span) for span in (1.3, -1.7) for old, new in (
            (coupled, belt), (belt, Standstill(0.1)), (blend, CoupledCam(BELT, phase=3.0)))]
        shut = [replace(way, new=Superposition((way.new, Standstill(way.gap)))) for way in ways]
        for motion in (coupled, belt, Superposition((coupled, belt)), blend, back, *shut):
            derivatives_fit(motion, -3.0, 9.0)
        for way in shut:  # joined to the second derivative at both ends
            assert abs(way.gap) < 1e-13
            for end in (way.start, way.end):
                near = way.sample(end + 1e-9), way.sample(end - 1e-9)
                assert near[0][:2] == pytest.approx(near[1][:2], abs=1e-8)

    def test_blend_is_smooth_at_its_ends(self):
        """Before the start it is the old motion, behind the end the new one, joined to y''."""
        old, new = CoupledCam(PRESS), CoupledCam(SMALL, phase=1.0, offset=0.2)
        for span in (0.8, -0.8):
            blend = Blend(old, new, 3.0, span)
            for at, motion in ((3.0, old), (3.0 + span, new)):
                near = blend.sample(at + 1e-9 * span), blend.sample(at - 1e-9 * span)
                assert near[0][:3] == pytest.approx(near[1][:3], abs=1e-6)
                assert blend.sample(at)[:3] == pytest.approx(motion.sample(at)[:3], abs=1e-12)

    def test_joints_of_a_coupled_cam(self):
        """Where a joint is announced, the third derivative steps, and nowhere else."""
        motion = CoupledCam(PRESS, ratio=2.0, phase=-1.0)
        joints = motion.joints(0.0, TURN)
        assert joints.size >= 2 * 5
        assert np.all(np.diff(joints) > 0.0)
        at = [(a * DEGREE + 1.0) / 2.0 for a in (60.0, 150.0, 200.0, 320.0)]
        assert all(np.min(np.abs(joints - x)) < 1e-12 for x in at)


class TestDemand:
    """What a motion demands."""

    def test_agrees_with_the_exact_peaks(self):
        """Grid peaks are within the margin of the exact ones, and so is the highest speed."""
        demand = Demand(CoupledCam(PRESS), 0.0, TURN)
        still = RampLimits(0.0, 0.0)
        peaks = demand.peaks(10.0, still)
        assert peaks.velocity == pytest.approx(10.0 * abs(PRESS.curve.peak(1).value), rel=3e-3)
        assert peaks.acceleration == pytest.approx(
            100.0 * abs(PRESS.curve.peak(2).value), rel=3e-3)
        limits = Limits(velocity=2.0, acceleration=30.0)
        exact = limits.highest_speed(PRESS).omega
        assert exact * 0.99 < demand.highest_speed(limits, still) <= exact

    @given(st.floats(0.5, 5.0), st.floats(5.0, 200.0), st.floats(100.0, 1e4))
    @settings(max_examples=40, deadline=None)
    def test_highest_speed_is_the_highest(self, velocity, acceleration, jerk):
        """At the speed found all limits hold; 2 % above, one breaks."""
        limits = Limits(velocity, acceleration, jerk)
        smooth = CoupledCam(SMALL)
        demand = Demand(Blend(Standstill(0.01), smooth, 1.0, 1.0), 1.0, 2.0)
        speed = demand.highest_speed(limits, RAMP)

        def within(omega):
            peaks = demand.peaks(omega, RAMP)
            return (peaks.velocity <= velocity and peaks.acceleration <= acceleration
                    and peaks.jerk <= jerk)
        assert speed == 0.0 or within(speed)
        assert not within(speed * 1.02 + 1e-6)


def turn(follower, omega, start, end, step=TURN / 1000.0):
    """Turn the shaft at a steady speed and give the setpoints."""
    count = max(1, round(abs(end - start) / step))
    return [follower.answer(start + (end - start) * k / count, omega, 0.0)
            for k in range(1, count + 1)]


def make(layout=None, engaged=True, **options):
    """Make a follower with limits that leave some room."""
    options.setdefault('limits', Limits(velocity=3.0, acceleration=120.0))
    return Follower(layout or layout_of(PRESS), FollowerSettings(**options), engaged)


class TestCommands:
    """Commands one by one."""

    def test_engaged_from_the_start(self):
        """The first shaft point puts the axis on its curve."""
        follower = make()
        assert follower.state is FollowerState.WAITING
        assert follower.answer(2.0, 5.0, 1.0) == PRESS.at_speed(2.0, 5.0, 1.0)
        assert follower.state is FollowerState.IN_SYNC

    def test_engage_at_an_angle(self):
        """It waits, engages where it was told to, and is exactly on the curve afterwards."""
        follower = make(engaged=False,
                        engage=Timing(At.ANGLE, span=60.0 * DEGREE, angle=90.0 * DEGREE))
        follower.answer(4.0, 10.0, 0.0)
        plan = follower.engage()
        assert follower.state is FollowerState.WAITING
        assert plan.blend.start == pytest.approx(TURN + 90.0 * DEGREE)
        turn(follower, 10.0, 4.0, plan.blend.start)
        turn(follower, 10.0, plan.blend.start, plan.blend.start + 0.3)
        assert follower.state is FollowerState.ENGAGING
        turn(follower, 10.0, plan.blend.start + 0.3, plan.blend.end + 0.1)
        assert follower.state is FollowerState.IN_SYNC
        assert follower.answer(11.0, 10.0, 2.0) == PRESS.at_speed(11.0, 10.0, 2.0)

    def test_disengage_at_cycle_end(self):
        """The axis stands from the end of the cycle on, where the cam has it then."""
        follower = make(layout_of(BELT),
                        disengage=Timing(At.CYCLE_END, span=30.0 * DEGREE))
        turn(follower, 8.0, 0.0, 3.0)
        plan = follower.disengage()
        assert plan.blend.end == pytest.approx(TURN)
        assert turn(follower, 8.0, 3.0, 3.0 * TURN)[-1] == (pytest.approx(0.3), 0.0, 0.0)
        assert follower.state is FollowerState.DISENGAGED

    def test_disengage_to_a_position(self):
        """The axis stands at the position it was given."""
        follower = make(stop_position=0.02)
        turn(follower, 6.0, 0.0, 2.5)
        follower.disengage()
        assert turn(follower, 6.0, 2.5, 40.0)[-1] == (0.02, 0.0, 0.0)

    def test_belt_never_turns_back(self):
        """A belt that engages joins the stroke ahead of it."""
        follower = make(layout_of(BELT), engaged=False)
        follower.answer(50.0, 6.0, 0.0)
        follower.engage()
        points = turn(follower, 6.0, 50.0, 60.0)
        assert follower.state is FollowerState.IN_SYNC
        assert min(velocity for _, velocity, _ in points) > -0.02
        assert -1e-9 < points[-1][0] < 0.3 * 3.5

    @pytest.mark.parametrize('master', [False, True])
    @pytest.mark.parametrize('slave', [False, True])
    def test_relative_on_either_side(self, master, slave):
        """Relative to the shaft, the cam begins where it engages; to the axis, it adds on."""
        start = 20.0
        follower = make(engaged=False, master_relative=master, slave_relative=slave,
                        stop_position=0.0)
        follower.answer(start, 5.0, 0.0)
        follower.engage()
        turn(follower, 5.0, start, start + 4.0 * TURN)
        phi = start + 4.0 * TURN + 1.0
        expected = PRESS.sample(phi - start if master else phi)[0]
        if slave:
            expected -= 0.0 if master else PRESS.sample(start)[0]
        assert follower.answer(phi, 5.0, 0.0)[0] == pytest.approx(expected, abs=1e-12)

    def test_change_of_phase_scale_offset_and_cam(self):
        """After a change the axis is exactly on what was asked for."""
        follower = make(layout_of(PRESS, SMALL))
        turn(follower, 5.0, 0.0, 1.0)
        new = replace(follower.layout, active=('two',), couplings={
            'one': Coupling(), 'two': Coupling(1.0, 0.3, 1.2, 0.01)})
        follower.change(new)
        turn(follower, 5.0, 1.0, 30.0)
        assert follower.state is FollowerState.IN_SYNC
        y = SMALL.sample(31.0 + 0.3)[0] * 1.2 + 0.01
        assert follower.answer(31.0, 5.0, 0.0)[0] == pytest.approx(y, abs=1e-12)

    def test_belt_changes_its_stroke_where_a_cycle_begins(self):
        """Another stroke counts from the beginning of the cycle in which it begins."""
        follower = make(layout_of(BELT, SHORT_BELT), change=Timing(At.CYCLE_END, span=0.5))
        turn(follower, 5.0, 0.0, 3.0 * TURN + 1.0)
        follower.change(replace(follower.layout, active=('two',)))
        end = turn(follower, 5.0, 3.0 * TURN + 1.0, 6.0 * TURN)[-1]
        assert end[0] == pytest.approx(4 * 0.3 + 2 * 0.2, abs=1e-12)

    def test_refused_change_leaves_everything(self):
        """A cam that the limits do not allow at this speed is refused, with the figures."""
        follower = make(layout_of(SMALL, PRESS), limits=Limits(acceleration=15.0))
        turn(follower, 12.0, 0.0, 1.0)
        before = follower.layout, follower.sample
        with pytest.raises(TransitionError, match='cycles/min'):
            follower.change(replace(follower.layout, active=('two',)))
        assert (follower.layout, follower.sample) == before
        assert follower.state is FollowerState.IN_SYNC

    def test_lengthened_or_refused(self):
        """A span that is too short is lengthened; if none fits, the figures say why."""
        limits = Limits(velocity=1.0, acceleration=15.0)
        short = Timing(span=5.0 * DEGREE)
        follower = make(engaged=False, limits=limits, engage=short)
        follower.answer(2.0, 10.0, 0.0)
        assert abs(follower.engage().blend.span) > 5.0 * DEGREE
        follower = make(engaged=False, limits=limits, engage=replace(short, longest=short.span))
        follower.answer(2.0, 10.0, 0.0)
        with pytest.raises(TransitionError, match=r'over 5 deg.*acceleration'):
            follower.engage()

    def test_positions_within_limits(self):
        """A transition that would leave the range of positions is refused."""
        follower = make(layout_of(PRESS), engaged=False, slave_relative=True,
                        limits=Limits(highest=0.04))
        follower.answer(0.0, 5.0, 0.0)
        with pytest.raises(TransitionError, match='limits of position'):
            follower.engage()

    @pytest.mark.parametrize('at', [At.NOW, At.ANGLE])
    def test_held_and_resumed(self, at):
        """Held on the curve, it resumes by a transition that ends on the curve."""
        follower = make(resume=Timing(at, span=1.0))
        turn(follower, 6.0, 0.0, 2.0)
        follower.coast()
        held = follower.answer(2.05, 0.0, 0.0)
        assert follower.state is FollowerState.STOPPING_ON_CURVE
        follower.hold(FollowerState.HELD, 'silence')
        assert follower.answer(5.0, 6.0, 0.0) == (held[0], 0.0, 0.0)
        with pytest.raises(TransitionError, match='silence'):
            follower.engage()
        plan = follower.reset()
        assert plan.blend.start % TURN == pytest.approx(5.0 if at is At.NOW else 2.05)
        turn(follower, 6.0, 5.0, 5.0 + 3.0 * TURN)
        assert follower.state is FollowerState.IN_SYNC
        assert follower.answer(40.0, 6.0, 0.5) == PRESS.at_speed(40.0, 6.0, 0.5)

    def test_resumes_at_once_where_it_stands(self):
        """At the angle at which it was held no transition is needed."""
        follower = make()
        turn(follower, 6.0, 0.0, 2.0)
        follower.coast()
        follower.answer(2.05, 0.0, 0.0)
        follower.hold(FollowerState.HELD, 'silence')
        follower.answer(2.05 + TURN, 0.0, 0.0)
        assert follower.reset() is None
        assert follower.state is FollowerState.IN_SYNC

    def test_told_to_stand_before_it_was_held(self):
        """An axis that was disengaging when it was held stands after the reset."""
        follower = make()
        turn(follower, 6.0, 0.0, 1.5)
        follower.disengage()
        turn(follower, 6.0, 1.5, 1.9)
        follower.coast()
        follower.hold(FollowerState.HELD, 'silence')
        assert follower.reset() is None
        assert follower.state is FollowerState.DISENGAGED


commands = st.lists(st.tuples(st.integers(1, 400), st.one_of(
    st.tuples(st.just('engage')), st.tuples(st.just('disengage')), st.tuples(st.just('reset')),
    st.tuples(st.just('stop')), st.tuples(st.just('run')), st.tuples(st.just('quick')),
    st.tuples(st.just('silence')),
    st.tuples(st.just('speed'), st.sampled_from([-60.0, 0.0, 30.0, 60.0, 90.0])),
    st.tuples(st.just('change'), st.sampled_from([('one',), ('two',), ('one', 'two')]),
              st.floats(-3.0, 3.0), st.sampled_from([0.5, 1.0, 1.1]), st.floats(-0.05, 0.05)),
)), min_size=1, max_size=14)
timings = st.builds(
    Timing, st.sampled_from(At), st.floats(0.2, 3.0), st.just(4.0 * TURN), st.floats(0.0, 6.0))


@pytest.mark.timeout(170)
@given(commands, timings, timings, timings, st.sampled_from([
    (PRESS, SMALL), (BELT, SHORT_BELT), (SMALL, PRESS)]), st.booleans(), st.booleans(),
    st.sampled_from([1.02, 1.3, 3.0]))
@settings(max_examples=120, deadline=None)
def test_never_jumps(script, engage, disengage, resume, cams, master, slave, room):
    """
    Throw commands at an axis and look at every tick.

    The shaft obeys what the axis allows, as the master does: it runs no faster, and slows down
    as soon as the axis asks for it, by its own ramp. The limits leave little room above what
    the first cam needs at the fastest.
    """
    needed = Demand(CoupledCam(cams[0]), 0.0, TURN).peaks(90.0 * RPM, RAMP)
    limits = Limits(velocity=needed.velocity * room, acceleration=needed.acceleration * room)
    follower = Follower(layout_of(*cams), FollowerSettings(
        limits, RAMP, engage, disengage, engage, resume, master, slave), engaged=True)
    shaft = Shaft(60.0 * RPM, RAMP, RAMP)
    shaft.run(0.0)
    t, before, silent, asked = 0.0, None, None, 60.0 * RPM
    for wait, (name, *arguments) in script:
        for _ in range(wait):
            t += TICK
            state = shaft.state(t)
            if silent is not None:
                if state.omega == 0.0 == state.alpha:
                    follower.answer(*state)
                    follower.hold(FollowerState.HELD, 'silence')
                    silent = None
            point = follower.answer(*state)
            if before is not None:
                check_step(before, point, limits)
            before = point
            obey(shaft, t, asked, follower)
        try:
            if name in ('engage', 'disengage', 'reset'):
                getattr(follower, name)()
            elif name == 'change':
                active, phase, scale, offset = arguments
                follower.change(Layout(
                    follower.layout.cams,
                    {n: Coupling(1.0, phase, scale, offset) for n in ('one', 'two')}, active))
            elif name == 'speed':
                asked = arguments[0] * RPM
            elif name == 'silence':
                follower.coast()
                shaft.stop(t)
                silent = t
            else:
                {'stop': shaft.stop, 'run': shaft.run, 'quick': shaft.quick_stop}[name](t)
        except (TransitionError, ShaftError):
            continue  # refused: nothing may have happened


def obey(shaft, t, asked, follower):
    """Run the shaft as fast as asked for, but no faster than the axis allows."""
    bound = follower.speed_bound
    speed = asked if bound is None else math.copysign(min(abs(asked), bound.omega), asked)
    if speed != shaft.speed:
        shaft.set_speed(t, speed)


def check_step(before, point, limits):
    """Check one tick against the one before."""
    (p0, v0, _), (p1, v1, a1) = before, point
    assert abs(v1) <= limits.velocity * (1.0 + 1e-6)
    assert abs(a1) <= limits.acceleration * (1.0 + 1e-6)
    # position and velocity are the integrals of what follows them: nothing jumps
    assert abs(p1 - p0) <= limits.velocity * TICK * (1.0 + 1e-6)
    assert abs(v1 - v0) <= limits.acceleration * TICK * (1.0 + 1e-6)
    assert math.isfinite(p1)


def test_state_before_any_shaft():
    """Commands before the first shaft point are refused or taken, never lost."""
    follower = make(engaged=False)
    with pytest.raises(TransitionError, match='no shaft'):
        follower.engage()
    follower = make()
    assert follower.disengage() is None
    assert follower.state is FollowerState.DISENGAGED
    assert follower.answer(1.0, 2.0, 0.0) == (0.0, 0.0, 0.0)


def test_shaft_state_is_what_the_axis_saw():
    """A transition begun between two ticks begins at the last one."""
    follower = make(engaged=False)
    follower.answer(*ShaftState(7.0, 3.0, 0.0))
    assert follower.engage().blend.start == 7.0


@pytest.mark.parametrize('alpha', [-5.0, 1.0, 20.0])
@pytest.mark.parametrize('name', ['disengage', 'engage', 'change'])
def test_a_shaft_that_changes_its_speed_is_no_reason_to_refuse(name, alpha):
    """What counts is what it may come to before it obeys, not the highest speed of the axis."""
    layout = layout_of(PRESS, SMALL)
    limits = Limits(acceleration=60.0)
    fastest = layout.speed_bound(limits).omega
    follower = make(layout, limits=limits, engaged=name != 'engage')
    follower.answer(1.0, 0.5 * fastest, alpha)
    other = replace(layout, couplings={n: Coupling(1.0, 0.3, 1.0, 0.0) for n in layout.couplings})
    plan = follower.change(other) if name == 'change' else getattr(follower, name)()
    assert plan.highest_speed > plan.speed >= 0.5 * fastest
    assert plan.speed < 0.6 * fastest
    assert follower.speed_bound.omega <= plan.highest_speed


def test_a_shaft_that_does_not_obey_is_reckoned_with_at_the_highest_speed_of_the_axis():
    layout = layout_of(PRESS, SMALL)
    limits = Limits(acceleration=60.0)
    fastest = layout.speed_bound(limits).omega
    follower = make(layout, limits=limits, obeyed=False)
    follower.answer(1.0, 0.3 * fastest, 0.0)
    weaker = replace(layout, couplings={n: Coupling(1.0, 0.0, 0.5, 0.0) for n in layout.couplings})
    assert follower.change(weaker).highest_speed >= fastest


def test_the_shaft_is_held_back_while_a_transition_needs_it():
    """From standstill a short transition allows less than the cam: the axis says so meanwhile."""
    short = Timing(span=20.0 * DEGREE, longest=20.0 * DEGREE)
    follower = make(engaged=False, engage=short)
    start = 100.0 * DEGREE
    follower.answer(start, 0.0, 0.0)
    plan = follower.engage()
    free = follower.layout.speed_bound(follower.settings.limits).omega
    assert plan.highest_speed < 0.9 * free
    assert follower.speed_bound.omega == plan.highest_speed
    shaft = Shaft(free, RAMP, RAMP, phi=start)
    shaft.run(0.0)
    t, before = 0.0, follower.answer(start, 0.0, 0.0)
    while follower.state is not FollowerState.IN_SYNC:
        obey(shaft, t, free, follower)
        t += TICK
        point = follower.answer(*shaft.state(t))
        check_step(before, point, follower.settings.limits)
        before = point
    assert follower.speed_bound.omega == pytest.approx(free)


def test_a_standing_axis_forgets_a_shaft_that_is_lost():
    """Disengaged while the shaft is lost, it does not engage with where that was."""
    follower = make(engaged=False)
    follower.answer(4.0, 6.0, 0.0)
    follower.coast()
    follower.hold(FollowerState.HELD, 'silence')
    assert follower.state is FollowerState.DISENGAGED
    with pytest.raises(TransitionError, match='no shaft'):
        follower.engage()


def test_a_change_while_held_keeps_where_the_axis_is_anchored():
    """An axis engaged relative to its position resumes relative to it, with the new coupling."""
    follower = make(engaged=False, slave_relative=True)
    start = 100.0 * DEGREE
    follower.answer(start, 5.0, 0.0)
    follower.engage()
    turn(follower, 5.0, start, start + 2.0 * TURN)
    anchor = follower.layout.shift
    assert anchor != 0.0
    follower.coast()
    follower.hold(FollowerState.HELD, 'silence')
    follower.change(layout_of(PRESS, offset=0.01))
    follower.answer(start, 5.0, 0.0)
    follower.reset()
    turn(follower, 5.0, start, start + 2.0 * TURN)
    y = PRESS.sample(start + 2.5 * TURN)[0] + 0.01 + anchor
    assert follower.answer(start + 2.5 * TURN, 5.0, 0.0)[0] == pytest.approx(y, abs=1e-12)


def test_a_change_that_waits_outlives_a_stop_that_is_called_off():
    """Told to change, then to stand, then not to, the axis still changes."""
    later = Timing(At.ANGLE, span=0.5, angle=6.0)
    follower = make(layout_of(PRESS, SMALL), change=later, disengage=later)
    turn(follower, 5.0, 0.0, 1.0)
    follower.change(replace(follower.layout, active=('two',)))
    follower.disengage()
    follower.engage()
    turn(follower, 5.0, 1.0, 3.0 * TURN)
    assert follower.state is FollowerState.IN_SYNC
    assert follower.answer(20.0, 5.0, 0.0)[0] == SMALL.sample(20.0)[0]


def run_shaft(follower, shaft, seconds, asked, limits=None, until=lambda: False):
    """Turn a shaft that obeys, from where it is, looking at every tick; give the setpoints."""
    t, points = shaft.now, []
    for _ in range(round(seconds / TICK)):
        t += TICK
        points.append(follower.answer(*shaft.state(t)))
        if limits is not None and len(points) > 1:
            check_step(points[-2], points[-1], limits)
        obey(shaft, t, asked, follower)
        if until():
            break
    shaft.now = t
    return points


def running_shaft(speed, phi=0.0, sense=1.0):
    """Make a shaft that runs at a steady speed."""
    shaft = Shaft(sense * speed, RAMP, RAMP, phi=phi)
    shaft.run(0.0)
    shaft.now = shaft.settled_at
    return shaft


TIGHT = Limits(velocity=5.0, acceleration=20.0)


@pytest.mark.parametrize('how', ['at the start', 'engage', 'reset'])
def test_an_axis_waits_for_a_shaft_that_is_too_fast_for_it(how):
    """It tells its bound, stands until the shaft has slowed down, and joins by a transition."""
    follower = make(limits=TIGHT, engaged=how != 'engage')
    free = follower.layout.speed_bound(TIGHT).omega
    if how == 'reset':
        turn(follower, 3.0, 0.0, 2.0)
        follower.coast()
        follower.answer(2.0, 0.0, 0.0)
        follower.hold(FollowerState.HELD, 'silence')
    shaft = running_shaft(2.0 * free)
    first = follower.answer(*shaft.state(shaft.now))
    if how != 'at the start':
        assert getattr(follower, how)() is None
    assert first[1:] == (0.0, 0.0)
    assert follower.state is FollowerState.WAITING
    assert follower.speed_bound.omega == free
    assert 'slowed down' in follower.waits_for
    points = run_shaft(follower, shaft, 8.0, 2.0 * free, TIGHT,
                       lambda: follower.state is FollowerState.IN_SYNC)
    assert follower.state is FollowerState.IN_SYNC
    assert points[0][0] == first[0]
    assert not follower.waits_for


def test_it_waits_for_as_slow_a_shaft_as_its_way_onto_the_curve_needs():
    short = Timing(span=20.0 * DEGREE, longest=20.0 * DEGREE)
    follower = make(limits=TIGHT, engage=short)
    free = follower.layout.speed_bound(TIGHT).omega
    shaft = running_shaft(1.5 * free, phi=-100.0)
    run_shaft(follower, shaft, 20.0, 1.5 * free, TIGHT,
              lambda: follower.state is FollowerState.IN_SYNC)
    assert follower.state is FollowerState.IN_SYNC


def test_an_axis_that_waits_can_be_told_to_stand_or_given_another_cam():
    follower = make(layout_of(PRESS, SMALL), limits=TIGHT)
    follower.answer(1.0, 100.0, 0.0)
    assert follower.waits_for
    assert follower.change(layout_of(PRESS, scale=0.001)) is None
    follower.answer(1.1, 100.0, 0.0)
    assert not follower.waits_for
    assert follower.plan is not None
    follower = make(limits=TIGHT)
    follower.answer(1.0, 100.0, 0.0)
    assert follower.disengage() is None
    assert follower.state is FollowerState.DISENGAGED
    assert follower.speed_bound is None
    follower.answer(1.1, 1.0, 0.0)
    assert follower.state is FollowerState.DISENGAGED


def test_a_shaft_that_cannot_be_slowed_down_is_no_place_to_join():
    follower = make(limits=TIGHT, engaged=False, obeyed=False)
    follower.answer(1.0, 100.0, 0.0)
    with pytest.raises(TransitionError, match='slow down first'):
        follower.engage()
    assert follower.state is FollowerState.DISENGAGED


def test_an_axis_says_by_how_much_the_shaft_exceeds_its_limits():
    follower = make(limits=TIGHT)
    follower.answer(1.0, 5.0, 0.0)
    assert follower.excess == ''
    follower.answer(1.1, 60.0, 0.0)
    assert '573 cycles/min' in follower.excess


def test_what_a_change_leads_away_from_bounds_the_shaft_until_it_begins():
    """With a smaller cam to come, the shaft does not run faster than the old one bears."""
    later = Timing(At.ANGLE, span=80.0 * DEGREE)
    follower = make(limits=TIGHT, change=later)
    free = follower.layout.speed_bound(TIGHT).omega
    shaft = running_shaft(free)
    run_shaft(follower, shaft, 0.1, 1e3)
    plan = follower.change(layout_of(PRESS, scale=0.2))
    assert plan.highest_speed > 1.2 * free
    assert follower.speed_bound.omega == free
    run_shaft(follower, shaft, 3.0, 1e3, TIGHT)
    assert follower.state is FollowerState.IN_SYNC
    assert follower.speed_bound.omega > 1.2 * free


def test_a_transition_on_top_of_another_obeys_that_until_it_begins():
    later = Timing(At.ANGLE, span=1.0, angle=6.0)
    follower = make(layout_of(PRESS, SMALL), limits=TIGHT)
    free = follower.layout.speed_bound(TIGHT).omega
    turn(follower, 0.3 * free, 0.0, 1.0)
    plan = follower.change(replace(follower.layout, active=('two',)))
    turn(follower, 0.3 * free, 1.0, 1.2)
    follower.settings = replace(follower.settings, change=later)
    follower.change(layout_of(PRESS, scale=0.01))
    assert follower.speed_bound.omega <= plan.highest_speed


@pytest.mark.parametrize('name', ['engage', 'disengage', 'change'])
def test_a_transition_planned_for_the_other_sense_is_planned_anew(name):
    """Commanded while the shaft stands or turns back, it is made whichever way that turns."""
    soon = Timing(At.ANGLE, span=1.0, angle=3.0)
    follower = make(engaged=name != 'engage', engage=soon, disengage=soon, change=soon)
    follower.answer(2.0, 1e-3, 0.0)
    if name == 'change':
        follower.change(layout_of(PRESS, scale=0.5))
    else:
        getattr(follower, name)()
    assert follower.plan.blend.span > 0.0
    turn(follower, -6.0, 2.0, -12.0)
    assert follower.plan is None
    through = FollowerState.DISENGAGED if name == 'disengage' else FollowerState.IN_SYNC
    assert follower.state is through


def test_a_transition_passed_back_over_its_start_is_planned_anew():
    follower = make()
    turn(follower, 6.0, 0.0, 2.0)
    follower.change(layout_of(PRESS, scale=0.5))
    turn(follower, 6.0, 2.0, 2.5)
    assert follower.state is FollowerState.CHANGING
    turn(follower, -6.0, 2.5, -12.0)
    assert follower.state is FollowerState.IN_SYNC
    assert follower.answer(-13.0, -6.0, 0.0)[0] == 0.5 * PRESS.sample(-13.0)[0]


def test_a_fault_is_not_covered_up_by_a_silence():
    follower = make()
    turn(follower, 6.0, 0.0, 2.0)
    follower.coast()
    follower.hold(FollowerState.FAULT, 'another shaft')
    follower.answer(2.0, 6.0, 0.0)
    follower.coast()
    follower.hold(FollowerState.HELD, 'silence')
    assert (follower.state, follower.reason) == (FollowerState.FAULT, 'another shaft')


@pytest.mark.parametrize('phi, omega, state', [
    (2.0, 0.0, FollowerState.IN_SYNC), (2.0 + TURN, 0.0, FollowerState.IN_SYNC),
    (2.3, 0.0, FollowerState.HELD), (2.0, 6.0, FollowerState.HELD)])
def test_held_in_place_it_goes_on_only_where_it_stands_on_its_curve(phi, omega, state):
    follower = make()
    turn(follower, 6.0, 0.0, 2.0)
    y = follower.answer(2.0, 0.0, 0.0)[0]
    follower.hold(FollowerState.HELD, 'deactivated', in_place=True)
    assert follower.answer(phi, omega, 0.0) == (y, 0.0, 0.0)
    assert follower.state is state
    follower.answer(2.0, 0.0, 0.0)
    assert follower.state is state  # only the first point counts
