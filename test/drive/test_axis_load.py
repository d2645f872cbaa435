# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The parts of a load on a drive that follows an axis: closed forms, balances, the servo drive."""

from dataclasses import replace
from math import cos, inf, nan, sin, sqrt

from cam_motion import CamProfile, segment
from cam_motion.drive.cycle import cycle_figures, cycle_nodes
from cam_motion.drive.inverse import FollowerDrive
from cam_motion.drive.load import (
    Friction,
    Lever,
    Process,
    RotatingInertia,
    Spring,
    TranslatingMass,
)
from cam_motion.drive.rigid_drive import RigidDrive
from cam_motion.drive.servo_axis import ServoAxis
from cam_motion.drive.servo_cycle import servo_cycle
from cam_motion.drive.servo_loop import ServoLoop
from cam_motion.drive.servo_motor import ServoMotor
from cam_motion.drive.set_motion import Setpoint
from cam_motion.drive.sizing_inverse import FollowerLoad
from cam_motion.errors import ConfigurationError
from cam_motion.units import DEGREE, RPM, TURN
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12
BALANCE = 1e-9  # of the work of a cycle
RADIUS, RATIO = 0.02, 3.0
SECOND = 10 ** 9
Y, V, A, PHI = 0.03, 0.7, -11.0, 1.5  # a setpoint, and the angle of the shaft with it
WINDOW = (1.0, 2.0)
# arm sin(phi) and what follows from it, for arm 0.2 m and height 0.1 m
REACH = sqrt(0.2 ** 2 - (0.1 - Y) ** 2)
LEVER_G = 1.0 / REACH  # dphi/dy [1/m]
LEVER_GG = -(0.1 - Y) / REACH ** 3  # its derivative with respect to y
CLOSED_FORMS = {  # the force that the part takes from the axis [N]
    'inertia': (RotatingInertia(0.5), 0.5 * A / RADIUS ** 2),
    'mass': (TranslatingMass(7.0), 7.0 * (A + 9.81)),
    'level mass': (TranslatingMass(7.0, 0.0), 7.0 * A),
    'spring': (Spring(20000.0, 0.01), 20000.0 * (Y + 0.01)),
    'friction': (Friction(30.0, 40.0), 30.0 * V + 40.0),
    'force': (Process(force=300.0, window=WINDOW), 300.0),
    'moment': (Process(moment=8.0, window=WINDOW), 8.0 / RADIUS),
    'lever': (Lever(0.05, 0.2, 0.1, 15.0, WINDOW),
              (0.05 * (LEVER_G * A + LEVER_GG * V ** 2) + 15.0) * LEVER_G),
}
EVERY = tuple(part for part, _ in CLOSED_FORMS.values())
PRESS = CamProfile([
    segment('wait', 60.0, 0.0, 'dwell'), segment('close', 150.0, -0.06, 'modified_sine'),
    segment('press', 250.0, -0.02, 'modified_sine'),
    segment('open', 340.0, 0.08, 'modified_sine'), segment('rest', 360.0, 0.0, 'dwell')])
CUT = (171.0 * DEGREE, 233.0 * DEGREE)
OMEGA = 100.0 * RPM
DRIVE = FollowerDrive(RADIUS, RATIO, 0.9, 1e-3, 4e-4, parts=EVERY)
MOTOR = ServoMotor.from_plate(
    standstill_torque=60.0, rated_torque=60.0, rated_speed=3000.0 * RPM, peak_torque=200.0,
    max_speed=5000.0 * RPM, inertia=1e-3)


@pytest.mark.parametrize('part, force', CLOSED_FORMS.values(), ids=CLOSED_FORMS.keys())
def test_each_part_takes_what_its_closed_form_says(part, force):
    state = FollowerDrive(RADIUS, RATIO, parts=(part,)).follow(Y, V, A, PHI)
    assert state.load_torque == pytest.approx(force * RADIUS, rel=ROUNDING)
    assert state.motor_torque == pytest.approx(force * RADIUS / RATIO, rel=ROUNDING)


def test_parts_add_up_with_what_the_drive_has_anyway():
    plain = replace(DRIVE, parts=(), resistance_force=55.0)
    single = [FollowerDrive(RADIUS, parts=(part,)).follow(Y, V, A, PHI).load_torque
              for part in EVERY]
    both = replace(plain, parts=EVERY).follow(Y, V, A, PHI).load_torque
    assert both == pytest.approx(plain.follow(Y, V, A).load_torque + sum(single), rel=ROUNDING)


def test_friction_turns_with_the_motion_and_a_process_does_not():
    def taken(part, velocity):
        return FollowerDrive(RADIUS, parts=(part,)).follow(Y, velocity, 0.0, PHI).load_torque
    friction = CLOSED_FORMS['friction'][0]
    assert taken(friction, -V) == -taken(friction, V) < 0.0
    assert taken(friction, 0.0) == 0.0
    assert {taken(CLOSED_FORMS['force'][0], v) for v in (-V, 0.0, V)} == {300.0 * RADIUS}


@pytest.mark.parametrize('phi, acts', [
    (0.999, 0.0), (1.0, 1.0), (2.0, 1.0), (2.001, 0.0), (1.5 + 7.0 * TURN, 1.0),
    (1.5 - TURN, 1.0), (nan, 0.0)])
def test_a_window_lies_over_the_angle_of_the_shaft_and_acts_only_where_that_is_known(phi, acts):
    drive = FollowerDrive(parts=(Process(force=300.0, window=WINDOW),))
    assert drive.follow(Y, V, A, phi).load_torque == 300.0 * acts
    assert drive.edges == WINDOW


def test_a_window_of_the_whole_turn_needs_no_angle():
    drive = FollowerDrive(parts=(Process(force=300.0), Lever(0.0, 0.2, 0.1, 15.0, (0.0, TURN))))
    assert drive.follow(Y, V, A).load_torque == pytest.approx(300.0 + 15.0 * LEVER_G)
    assert drive.edges == ()


def test_one_setpoint_and_many_give_the_same():
    shares = np.random.default_rng(7).uniform(-0.05, 0.05, (4, 50))
    y, v, a, phi = shares * [[1.0], [20.0], [400.0], [99.0]]
    many = DRIVE.follow_all(y, v, a, phi)
    for k, point in enumerate(zip(y.tolist(), v.tolist(), a.tolist(), phi.tolist())):
        one = DRIVE.follow(*point)
        assert one == pytest.approx([column[k] for column in many], rel=ROUNDING, abs=1e-12)
        assert all(type(value) is not np.ndarray for value in one)


def travel(profile, low, high):
    return float(profile.curve(high) - profile.curve(low))


def test_the_work_of_a_cycle_is_what_friction_and_process_take():
    viscous, coulomb, force, moment = 150.0, 60.0, -3000.0, 2.5
    parts = (TranslatingMass(40.0), Spring(12000.0, -0.033), RotatingInertia(0.01),
             Lever(0.05, 0.3, 0.1), Friction(viscous, coulomb), Process(force, moment, CUT))
    drive = FollowerDrive(RADIUS, RATIO, 1.0, 1e-3, 4e-4, parts=parts)
    nodes = cycle_nodes(PRESS, OMEGA)
    lost = coulomb * 0.16 + viscous * float(nodes.weights @ nodes.inner[1] ** 2)
    cut = (force + moment / RADIUS) * travel(PRESS, *CUT)
    figures = cycle_figures(drive, PRESS, OMEGA)
    assert cut > 40.0
    assert figures.motor_energy == pytest.approx(lost + cut, rel=BALANCE)


@pytest.mark.parametrize('efficiency', [0.9, 0.4])
def test_with_losses_the_work_of_the_motor_is_that_and_what_the_gearbox_takes(efficiency):
    drive = replace(DRIVE, efficiency=efficiency)
    nodes = cycle_nodes(PRESS, OMEGA, drive.edges)
    state = drive.follow_all(*nodes.inner)
    power = state.load_torque * state.load_velocity
    gear = np.where(power > 0.0, power * (1.0 / efficiency - 1.0), -power * (1.0 - efficiency))
    assert gear.min() >= 0.0
    free = cycle_figures(replace(DRIVE, efficiency=1.0), PRESS, OMEGA).motor_energy
    assert cycle_figures(drive, PRESS, OMEGA).motor_energy == pytest.approx(
        free + float(nodes.weights @ gear), rel=BALANCE)


def test_the_peak_at_the_edge_of_a_window_is_met_from_its_side():
    drive = FollowerDrive(RADIUS, parts=(Process(force=-3000.0, window=CUT),
                                         Spring(12000.0, -0.033)))
    low, high = (12000.0 * (PRESS.curve(q) - 0.033) for q in CUT)
    assert cycle_figures(drive, PRESS, OMEGA).peak_torque == pytest.approx(
        (3000.0 - min(low, high)) * RADIUS, rel=1e-7)


def test_sizing_sees_the_whole_load():
    load = FollowerLoad(DRIVE, PRESS, OMEGA)
    nodes = cycle_nodes(PRESS, OMEGA, DRIVE.edges)
    state = DRIVE.follow_all(*nodes.dense)
    assert load.peak_torque == pytest.approx(np.abs(state.load_torque).max(), rel=ROUNDING)
    lever = max(0.05 / (0.2 ** 2 - (0.1 - y) ** 2) for y in nodes.dense[0])
    assert load.inertia == pytest.approx(
        4e-4 + 0.5 + (14.0 + lever) * RADIUS ** 2, rel=1e-9)


def servo_of(drive, hertz=40.0, substep_ns=250_000, **gains):
    inertia = drive.motor_inertia + drive.law(0.0).inertia / drive.gear_ratio ** 2
    loop = ServoLoop.for_bandwidth(hertz * TURN, inertia, **gains)
    return ServoAxis(drive, MOTOR, loop, substep_ns)


def press_setpoints(rate, turns=1):
    for k in range(round(turns * 0.6 * rate) + 1):
        time_ns = k * SECOND // rate
        phi = OMEGA * time_ns * 1e-9
        y, slope, bend, _ = PRESS.sample(phi)
        yield Setpoint(time_ns, y, slope * OMEGA, bend * OMEGA ** 2, phi)


def through(servo, points):
    points = iter(points)
    return [servo.start(next(points)), *(servo.follow(point) for point in points)]


def test_a_servo_drive_on_its_loads_follows_as_the_inverse_says():
    drive = replace(DRIVE, parts=(*EVERY[:5], Process(-200.0, 0.0, CUT), EVERY[-1]))
    states = through(servo_of(drive), points := list(press_setpoints(500)))
    assert max(abs(s.following_error) for s in states) < 2e-6
    # its torque stands for a period, and belongs to the middle of it
    exact = np.array([drive.follow(p.position, p.velocity, p.acceleration, p.shaft_angle
                                   - OMEGA * 125e-6).motor_torque for p in points])
    found = np.array([s.drive.motor_torque for s in states])
    off = np.abs(found - exact) / np.abs(exact).max()
    assert np.median(off) < 2e-3


def test_without_feed_forward_of_torque_the_loop_holds_the_loads():
    drive = replace(DRIVE, parts=(TranslatingMass(40.0), Spring(12000.0, 0.1)))
    servo = servo_of(drive, torque_feed_forward=0.0)
    states = through(servo, (Setpoint(k * 2_000_000, 0.02) for k in range(1000)))
    held = drive.follow(0.02, 0.0, 0.0).load_torque
    assert abs(states[-1].following_error) < 1e-9
    assert states[-1].drive.load_torque == pytest.approx(held, rel=1e-6)


def test_the_motion_does_not_depend_on_the_rate_of_the_setpoints():
    drive = replace(DRIVE, parts=EVERY)

    def smooth(step_ns):
        for t in range(0, 600_000_000 + 1, step_ns):
            u = t / 600_000_000
            yield Setpoint(t, 0.05 * u ** 3 * (10.0 - u * (15.0 - 6.0 * u)),
                           1.5 / 0.6 * (u * (1.0 - u)) ** 2,
                           3.0 / 0.36 * u * (1.0 - u * (3.0 - 2.0 * u)), 3.01 * u)
    slow = through(servo_of(drive), smooth(2_000_000))
    fast = through(servo_of(drive), smooth(400_000))[::5]
    for one, other in zip(slow, fast):
        assert one.position == pytest.approx(other.position, abs=1e-10)
        assert one.velocity == pytest.approx(other.velocity, abs=1e-8)


def test_a_spring_neither_gains_nor_loses_energy_in_the_integration():
    """A mass on a spring, no torque: half a million substeps later it swings as far as before."""
    spring, mass = 50_000.0, 2.0
    drive = FollowerDrive(1.0, 1.0, 1.0, mass, parts=(Spring(spring),))
    position, velocity, step = 0.01, 0.0, 250e-6
    farthest = 0.0
    for k in range(200_000):
        rigid = RigidDrive.of(drive, position + 0.5 * step * velocity)
        position, velocity, _, _ = rigid.move(position, velocity, 0.0, step)
        farthest = max(farthest, abs(position)) if k > 199_000 else 0.0
    assert farthest == pytest.approx(0.01, rel=1e-3)


def test_damping_of_any_size_brings_a_drive_to_rest():
    drive = FollowerDrive(1.0, 1.0, 1.0, 1.0, parts=(Friction(viscous=1e6),))
    speeds, position, velocity = [], 0.0, 3.0
    for _ in range(2000):
        rigid = RigidDrive.of(drive, position, velocity=velocity, ahead=125e-6)
        position, velocity, _, _ = rigid.move(position, velocity, 0.0, 250e-6)
        speeds.append(abs(velocity))
    assert max(speeds) <= 3.0
    assert speeds[-1] < 1e-6


def test_a_cycle_of_a_servo_drive_knows_the_angle_of_the_shaft():
    drive = replace(DRIVE, efficiency=1.0,
                    parts=(TranslatingMass(40.0), Process(-3000.0, 0.0, CUT)))
    cycle = servo_cycle(servo_of(drive), PRESS, OMEGA, 500.0)
    free = servo_cycle(servo_of(replace(drive, parts=drive.parts[:1])), PRESS, OMEGA, 500.0)
    cut = 3000.0 * -travel(PRESS, *CUT)
    assert cycle.tally.motor_work - free.tally.motor_work == pytest.approx(cut, rel=1e-3)


def test_springs_too_stiff_for_the_substep_are_refused():
    drive = FollowerDrive(1.0, 1.0, 1.0, 1e-3, parts=(Spring(1e6),))
    with pytest.raises(ConfigurationError, match='softer springs'):
        servo_of(drive)


def test_a_lever_out_of_reach_leaves_the_load_as_it_was():
    drive = replace(DRIVE, parts=(Lever(0.05, 0.2, 0.1),))
    states = through(servo_of(drive), (
        Setpoint(k * 2_000_000, 0.29 + 0.1 * sin(0.01 * k), 0.5 * cos(0.01 * k))
        for k in range(100)))
    assert all(abs(s.position) < inf for s in states)
    assert np.isnan(drive.follow(0.31, 0.0, 0.0).load_torque)
