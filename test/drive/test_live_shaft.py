# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The shaft in real time: the motion of the slow solvers, whoever looks at it, and honest rest."""

from math import pi

from cam_motion import CamProfile, segment
from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.live_shaft import LiveShaft
from cam_motion.drive.load import Friction, Lever, RotatingInertia, Spring, TranslatingMass
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.drive.orbit import find_orbit
from cam_motion.drive.shaft_field import compile_field
from cam_motion.drive.shaft_torque import Command, ShaftTorque
from cam_motion.drive.start_up import start_up
from cam_motion.drive.time_stepping import step_in_time
from cam_motion.units import RPM, TURN
from hypothesis import given, settings
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

HARMONIC = (0.0, 0.0, 0.5, 0.0, 0.5, 0.0, 0.0)
PROFILE = CamProfile([
    segment('rise', 150.0, 0.06, 'modified_trapezoid', fractions=HARMONIC),
    segment('return', 360.0, -0.06, 'modified_trapezoid', fractions=HARMONIC)])
MOTOR = InductionMotor(1500.0 * RPM, 27.27, 0.315, 1.587, 1.416, 0.0028)
KLOSS = KlossMotor(1500.0 * RPM, 27.27, 0.315, 0.0028)
SECOND = 10**9
STEP = 500_000
BRAKE = 27.27
ROUNDING = 1e-12
SAME_MOTION = 1e-9  # relative: order 4 with substeps of 0.5 ms
ON_ORBIT = 1e-9


def cam(parts, motor=MOTOR, efficiency=0.9, flywheel=0.06, ratio=3.5525, profile=PROFILE):
    """Make a drive with a load of its own."""
    return CamDrive(profile, parts, motor, Gearbox(ratio, efficiency, 0.0038), flywheel,
                    400.0 * RPM)


def running(drive, step=STEP):
    """Make a shaft whose motor is switched on at once."""
    live = LiveShaft(drive, step, BRAKE)
    live.tell(0, Command.RUN)
    return live


PARTS = (RotatingInertia(0.02), TranslatingMass(7.0), Spring(20000.0, 0.01), Friction(30.0, 40.0),
         Lever(0.05, 0.18, 0.148, 150.0, (0.0, 5.0 * pi / 6.0)))


@pytest.mark.parametrize('motor', [MOTOR, KLOSS])
@given(q=st.floats(0.0, TURN), omega=st.floats(0.01, 60.0))
@settings(max_examples=60, deadline=None)
def test_the_written_out_equation_is_that_of_the_parts(motor, q, omega):
    drive = cam(PARTS, motor)
    law = ShaftTorque(drive, BRAKE)
    element = next(e for e in FIELD if e.start <= q <= e.end)
    torque = law.law(Command.RUN, 1.0, fast=omega > law.synchronous)
    whole = next(e for e in drive.elements if e.start <= q <= e.end)
    if element.start < whole.start or element.end > whole.end:  # at an end both are right
        return
    want = drive.acceleration(drive.follower(whole, np.array([q])), np.array([omega]))[0]
    assert element.acceleration(q, omega, 1.0, torque) == pytest.approx(want, rel=1e-9, abs=1e-9)


FIELD = compile_field(cam(PARTS))


def test_elements_of_the_field_cover_the_turn_without_a_gap():
    assert FIELD[0].start == 0.0
    assert FIELD[-1].end == TURN
    assert all(a.end == b.start for a, b in zip(FIELD, FIELD[1:]))


def test_friction_acts_against_the_motion_whichever_way_it_goes():
    smooth = compile_field(cam((RotatingInertia(0.1),)))[1]
    rubbing = compile_field(cam((RotatingInertia(0.1), Friction(0.0, 40.0))))[1]
    x = 0.5 * (smooth.start + smooth.end)
    forwards, backwards = (
        rubbing.acceleration(x, s, s, lambda w: 0.0) - smooth.acceleration(
            x, s, s, lambda w: 0.0) for s in (1.0, -1.0))
    assert forwards < 0.0 < backwards
    assert forwards == pytest.approx(-backwards, rel=ROUNDING)


def test_the_motion_from_rest_is_that_of_the_energy_equation(press):
    drive = press()
    exact = start_up(drive, 3.0)
    live = running(drive)
    worst = [0.0, 0.0]
    for k in range(100, 2000):
        t = k * 1_500_000
        state = live.state(t)
        turn, q = divmod(state.phi, TURN)
        stretch = next((s for s, n in zip(exact.stretches, exact.turns)
                        if n == turn and s.element.start <= q <= s.element.end), None)
        if stretch is None:
            continue
        at = np.array([q])
        worst[0] = max(worst[0], abs(state.omega / float(stretch.omega(at)[0]) - 1.0))
        worst[1] = max(worst[1], abs(1e-9 * t - float(stretch.times(at)[0])))
    assert worst[0] < SAME_MOTION
    assert worst[1] < SAME_MOTION


def test_the_motion_is_that_of_the_slow_solver(press):
    drive = press(flywheel=0.02)
    slow = step_in_time(drive, 0.5, rtol=1e-11)
    state = running(drive).state(SECOND // 2)
    assert state.phi == pytest.approx(slow.q[-1], rel=SAME_MOTION)
    assert state.omega == pytest.approx(slow.omega[-1], rel=SAME_MOTION)


def test_halving_the_substep_takes_the_error_of_order_four(press):
    drive = press()
    phi = [running(drive, step).state(SECOND).phi for step in (125_000, 1_000_000, 2_000_000)]
    order = np.log2((phi[2] - phi[0]) / (phi[1] - phi[0]))
    assert 3.5 < order < 4.6


def test_settled_it_turns_as_the_periodic_motion_says(press):
    drive = press()
    orbit, live = find_orbit(drive), running(drive)
    worst, low, high = 0.0, np.inf, 0.0
    for t in range(3 * SECOND, 4 * SECOND, 2_000_000):
        state = live.state(t)
        q = state.phi % TURN
        stretch = next(s for s in orbit.stretches if s.element.start <= q <= s.element.end)
        worst = max(worst, abs(state.omega / float(stretch.omega(np.array([q]))[0]) - 1.0))
        low, high = min(low, state.omega), max(high, state.omega)
    assert worst < ON_ORBIT
    assert (low, high) == pytest.approx(orbit.speeds, rel=1e-4)  # as far as ticks meet them


@pytest.mark.parametrize('rate', [1000, 500, 333, 100, 7])
def test_the_motion_is_the_same_to_the_bit_at_any_rate(press, rate):
    drive = press()
    plain = running(drive)
    looked_at = running(drive)
    for k in range(2 * rate + 1):
        t = (2 * k * SECOND + rate) // (2 * rate)
        state = looked_at.state(t)
        if t % SECOND == 0:
            assert state == plain.state(t)
    assert looked_at.state(2_000_000_123) == plain.state(2_000_000_123)


def test_the_energy_of_spring_and_mass_is_conserved_through_reversals():
    spring, mass = Spring(20000.0, 0.01), TranslatingMass(7.0)
    drive = cam((RotatingInertia(0.02), mass, spring))
    live = LiveShaft(drive, STEP, BRAKE, phi=1.0)
    live.tell(0, Command.COAST)

    def energy(state):
        s, slope, _, _ = PROFILE.sample(state.phi % TURN)
        inertia = drive.fixed_inertia + 0.02 + mass.mass * slope ** 2
        return (0.5 * inertia * state.omega ** 2 + mass.mass * mass.gravity * s
                + 0.5 * spring.stiffness * (s + spring.preload) ** 2)

    states = [live.state(t) for t in range(0, 5 * SECOND, 3_000_000)]
    assert min(s.omega for s in states) < -1.0 < 1.0 < max(s.omega for s in states)
    energies = [energy(state) for state in states]
    assert energies == pytest.approx([energies[0]] * len(energies), rel=1e-8)


def test_the_work_of_the_motor_goes_into_energy_and_load():
    drive = cam((RotatingInertia(0.5),), efficiency=1.0)
    live = running(drive)
    work, before = 0.0, live.state(0)
    for t in range(100_000, SECOND + 1, 100_000):
        state = live.state(t)
        work += 0.5 * (state.motor_torque + before.motor_torque) * 3.5525 * (
            state.phi - before.phi)
        before = state
    inertia = drive.fixed_inertia + 0.5
    assert work == pytest.approx(0.5 * inertia * before.omega ** 2, rel=1e-6)  # trapezoids


def test_the_torques_of_a_state_balance(press):
    drive = press()
    live = running(drive)
    for t in (SECOND, SECOND + 31_234_567, SECOND + 77_000_000):
        state = live.state(t)
        element = next(e for e in drive.elements if e.start <= state.phi % TURN <= e.end)
        at = drive.follower(element, np.array([state.phi % TURN]))
        terms = drive.terms(at)
        load = float(terms.inertia[0] - drive.fixed_inertia) * state.alpha + float(
            terms.centripetal[0]) * state.omega ** 2 - float(terms.force[0])
        gain = float(drive.gearbox.gain(state.motor_torque, state.omega))
        assert state.shaft_torque == pytest.approx(gain * state.motor_torque, rel=ROUNDING)
        assert state.load_torque == pytest.approx(load, rel=1e-9)


def test_the_brake_stops_the_shaft_and_holds_it(press):
    live = running(press())
    live.state(2 * SECOND)
    live.tell(2 * SECOND, Command.BRAKE)
    braking = live.state(2 * SECOND)
    assert (braking.motor_torque, braking.brake_torque) == (0.0, -BRAKE)
    ratio, efficiency = 1421.0 / 400.0, 0.9
    assert braking.shaft_torque == pytest.approx(-BRAKE * ratio / efficiency, rel=ROUNDING)
    rest = live.state(3 * SECOND)
    assert live.standing
    assert (rest.omega, rest.alpha) == (0.0, 0.0)
    assert live.state(60 * SECOND) == rest
    # it is the brake that holds, not the motor, which is off
    assert rest.motor_torque == 0.0
    assert 0.0 < abs(rest.brake_torque) < BRAKE
    assert live.stops == 0


def test_a_brake_holds_up_to_its_torque_through_the_losses_of_the_gearbox():
    spring = (RotatingInertia(0.02), Spring(20000.0, 0.01))
    drive = cam(spring)
    element = next(e for e in compile_field(drive) if e.start <= 1.0 <= e.end)
    # driven by the load, the gearbox helps the brake by its losses
    needed = abs(element.force(1.0)) / drive.gearbox.ratio * drive.gearbox.efficiency
    for share, stands in ((0.999, False), (1.001, True)):
        live = LiveShaft(drive, STEP, share * needed, phi=1.0)
        live.tell(0, Command.BRAKE)
        assert live.standing is stands
        assert (live.state(SECOND // 10).phi == 1.0) is stands


def test_a_shaft_without_power_comes_to_rest_by_friction_at_a_place_of_balance():
    drive = cam((RotatingInertia(0.02), Spring(20000.0), Friction(50.0, 40.0)))
    live = LiveShaft(drive, STEP, BRAKE, phi=1.2)
    live.tell(0, Command.COAST)
    assert not live.standing
    rest = live.state(20 * SECOND)
    assert live.standing
    _, slope, _, _ = PROFILE.sample(rest.phi % TURN)
    assert abs(rest.load_torque) <= 40.0 * abs(slope) + ROUNDING


def test_a_motor_that_cannot_lift_the_load_rocks_or_stands_and_says_so():
    weak = InductionMotor(1500.0 * RPM, 3.0, 0.315, 1.587, 1.416, 0.0028)
    live = running(cam((RotatingInertia(0.02), Spring(20000.0, 0.05)), motor=weak))
    states = [live.state(t) for t in range(0, 4 * SECOND, SECOND // 500)]
    assert live.stops > 0
    assert max(s.phi for s in states) < 2.0
    assert min(s.omega for s in states) < 0.0  # thrown back before it settles
    assert live.standing
    held = live.state(5 * SECOND)
    # the losses of the gearbox keep it between what drives and what holds
    through = 3.5525 * held.motor_torque
    assert 0.9 * through <= held.load_torque <= through / 0.9


def test_a_motor_that_cannot_start_stands_at_once():
    weak = InductionMotor(1500.0 * RPM, 0.1, 0.315, 1.587, 1.416, 0.0028)
    live = LiveShaft(cam((RotatingInertia(0.02), TranslatingMass(5.0), Friction(0.0, 2000.0)),
                         motor=weak), STEP, BRAKE, phi=0.8)
    live.tell(SECOND, Command.RUN)
    assert live.standing
    assert live.stops == 1
    assert live.state(9 * SECOND).phi == pytest.approx(0.8)


def test_a_vee_of_the_load_is_a_place_of_rest():
    # the moment pushes back within its window only: a shaft at its edge is held from both sides
    lever = Lever(0.05, 0.18, 0.148, 400.0, (1.0, 2.0))
    drive = cam((RotatingInertia(0.02), Spring(-2000.0, 0.1), lever, Friction(0.0, 100.0)))
    live = LiveShaft(drive, STEP, BRAKE, phi=0.9)
    live.tell(0, Command.COAST)
    rest = live.state(20 * SECOND)
    assert live.standing
    assert rest.phi == pytest.approx(1.0, abs=1e-8)


def test_past_the_synchronous_speed_the_losses_change_sides(press):
    live = running(press())
    gains = {round(s.shaft_torque / s.motor_torque, 9)
             for s in (live.state(t) for t in range(SECOND, 2 * SECOND, 1_000_000))}
    ratio = 1421.0 / 400.0
    assert gains == {round(ratio * 0.9, 9), round(ratio / 0.9, 9)}


def test_switched_off_it_coasts_and_switched_on_again_it_returns_to_the_same_motion(press):
    drive = press()
    orbit, live = find_orbit(drive), running(drive)
    live.tell(2 * SECOND + 1, Command.COAST)
    assert live.state(2 * SECOND + SECOND // 10).motor_torque == 0.0
    live.tell(2 * SECOND + SECOND // 10, Command.RUN)
    state = live.state(5 * SECOND)
    q = state.phi % TURN
    stretch = next(s for s in orbit.stretches if s.element.start <= q <= s.element.end)
    assert state.omega == pytest.approx(float(stretch.omega(np.array([q]))[0]), rel=ON_ORBIT)


def test_arrested_it_stands_where_it_is(press):
    live = running(press())
    turning = live.state(SECOND)
    live.arrest(SECOND)
    state = live.state(2 * SECOND)
    assert (state.phi, state.omega, state.alpha) == (turning.phi, 0.0, 0.0)
    live.tell(2 * SECOND, Command.RUN)
    assert live.state(3 * SECOND).omega > 30.0


@given(phi=st.floats(0.0, TURN), when=st.integers(1, 10**9), brake=st.floats(1.0, 60.0))
@settings(max_examples=15, deadline=None)
def test_nothing_jumps_and_time_alone_moves_it(phi, when, brake):
    live = LiveShaft(DRIVE, 1_000_000, brake, phi=phi)
    live.tell(0, Command.RUN)
    before = live.state(when)
    live.tell(when, Command.BRAKE)
    after = live.state(when)
    assert (after.phi, after.omega) == (before.phi, before.omega)
    soon = live.state(when + 1000)
    assert soon.phi == pytest.approx(after.phi + 1e-6 * after.omega, abs=1e-8)
    assert np.all(np.isfinite(live.state(when + SECOND)))


DRIVE = cam(PARTS)
