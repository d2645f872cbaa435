# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Sweeps over designs, against the exact solver one by one, and against themselves."""

from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import fields, replace
from math import pi
import multiprocessing

from cam_motion import CamProfile, segment
from cam_motion.drive import sweep as sweep_module
from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.load import Friction, RotatingInertia, Spring, TranslatingMass
from cam_motion.drive.motor import InductionMotor, KlossMotor
from cam_motion.drive.orbit import find_orbit, NoOrbitError
from cam_motion.drive.sweep import Designs, OrbitTable, sweep, sweep_orbits
from cam_motion.errors import ConfigurationError
from cam_motion.units import RPM
from hypothesis import given, HealthCheck, reject, settings
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

pytestmark = pytest.mark.timeout(60)

LOSSLESS = 1e-5  # asked of the work drawn, whose cells a lossless gearbox does not cut
CLOSE = 2e-3  # asked of the least force, as a share of its swing
EXACT = 1e-6  # asked of all figures; relative, the multiplier absolute
BACK = 1e-6  # asked of the energy after a revolution, integrated by a general solver
DENSE = 2001

NOMINAL = 400.0 * RPM
WORKERS = 2


def motors(draw):
    poles = draw(st.integers(1, 4))
    speed = 2.0 * pi * 50.0 / poles
    torque = draw(st.floats(5.0, 200.0))
    slip = draw(st.floats(0.12, 0.5))
    if draw(st.booleans()):
        return KlossMotor(speed, torque, slip, 1e-4 * torque)
    sharpness = draw(st.floats(0.5, 1.2)) / slip
    try:
        return InductionMotor(
            speed, torque, slip, sharpness, draw(st.floats(0.0, 0.5)), 1e-4 * torque)
    except ConfigurationError:  # a pole
        return reject()


@st.composite
def drives(draw, press_profile, press_parts):
    motor = motors(draw)
    ratio = draw(st.floats(0.75, 0.97)) * motor.synchronous_speed / NOMINAL
    gearbox = Gearbox(ratio, draw(st.sampled_from([1.0, 0.95, 0.9, 0.8])), 0.004)
    flywheel = draw(st.sampled_from([0.0, 1e-3, 1e-2, 0.06, 0.2]))
    return CamDrive(press_profile, press_parts, motor, gearbox, flywheel, NOMINAL)


def exact(orbit):
    """Take the figures from the exact solver, the extremes by looking closely."""
    drive = orbit.stretches[0].drive
    ratio = drive.gearbox.ratio
    x, weights = np.polynomial.legendre.leggauss(20)
    speeds, heat, drawn = [], 0.0, 0.0
    for stretch in orbit.stretches:
        start, end = stretch.element.start, stretch.element.end

        def torque(q, stretch=stretch):
            return drive.motor.torque(ratio * stretch.omega(np.atleast_1d(q)))
        omega = stretch.omega(start + 0.5 * (end - start) * (x + 1.0))
        heat += 0.5 * (end - start) * float(
            weights @ (drive.motor.torque(ratio * omega) ** 2 / omega))
        q = np.linspace(start, end, DENSE)
        speeds.append(stretch.omega(q))
        ends = [start, *(brentq(lambda q: torque(q)[0], q[k], q[k + 1]) for k in np.flatnonzero(
            torque(q)[1:] * torque(q)[:-1] < 0.0)), end]
        drawn += sum(max(0.0, ratio * 0.5 * (b - a) * float(
            weights @ torque(a + 0.5 * (b - a) * (x + 1.0)))) for a, b in zip(ends, ends[1:]))
    omega = np.concatenate(speeds)
    return (omega[0], omega.min(), omega.max(), orbit.period, orbit.motor_work, drawn,
            (heat / orbit.period) ** 0.5, np.abs(drive.motor.torque(ratio * omega)).max(),
            orbit.multiplier)


def force_on(orbit):
    """Look closely at the force that presses the follower on the cam."""
    drive = orbit.stretches[0].drive
    found = []
    for stretch in orbit.stretches:
        q = np.linspace(stretch.element.start, stretch.element.end, DENSE)
        found.append(drive.follower_force(drive.follower(stretch.element, q), *stretch.motion(q)))
    return np.concatenate(found)


def but_the_force(table):
    """Take the columns that are exact; the least force is looked at on its own."""
    return [column for name, column in table._asdict().items()
            if name not in ('found', 'least_follower_force')]


def comes_back(drive, speed):
    """Integrate dE/dq = Q over one turn; tell by how much the energy changes, relative."""
    first = None
    for element in drive.elements:
        def power(q, state, element=element):
            terms = drive.terms(drive.follower(element, np.array([q])))
            omega = np.sqrt(2.0 * state / terms.inertia)
            return terms.force + terms.damping * omega + drive.motor_torque(omega)
        if first is None:
            inertia = drive.terms(drive.follower(element, np.zeros(1))).inertia[0]
            energy = first = 0.5 * inertia * speed ** 2
        energy = solve_ivp(power, (element.start, element.end), [energy], method='DOP853',
                           rtol=1e-9, atol=1e-9).y[0, -1]
    return energy / first - 1.0


def check(drive, table, number):
    """Compare one design with the exact solver, which is shown about where to look."""
    if not table.found[number]:
        with pytest.raises(NoOrbitError):
            find_orbit(drive)
        return
    middle = float(0.5 * (table.min_speed[number] + table.max_speed[number]))
    try:
        orbit = find_orbit(replace(drive, nominal_speed=middle))
    except NoOrbitError:  # its Newton's method starts at one speed only
        assert abs(comes_back(drive, table.start_speed[number])) < BACK
        return
    *ours, multiplier = (float(column[number]) for column in but_the_force(table))
    *theirs, slope = exact(orbit)
    drawn = ours.pop(5), theirs.pop(5)
    assert ours == pytest.approx(theirs, rel=EXACT)
    assert drawn[0] == pytest.approx(
        drawn[1], rel=EXACT if drive.gearbox.efficiency < 1.0 else LOSSLESS)
    force = force_on(orbit)
    assert orbit.least_follower_force == pytest.approx(force.min(), abs=1e-5 * np.ptp(force))
    assert table.least_follower_force[number] == pytest.approx(
        force.min(), abs=CLOSE * np.ptp(force))
    assert multiplier == pytest.approx(slope, abs=EXACT)


@pytest.fixture(scope='module')
def grid(press):
    """Make motors, ratios and flywheels around the document's choice, too weak ones among them."""
    given_drive = press()
    found = []
    for torque in np.geomspace(4.0, 120.0, 7):
        for share in (0.8, 0.9, 0.96):
            for flywheel in (0.0, 0.01, 0.06, 0.2):
                motor = KlossMotor(1500.0 * RPM, float(torque), 0.3, 1e-4 * float(torque))
                gearbox = Gearbox(1500.0 / 400.0 * share, 0.9, 0.004)
                found.append(replace(
                    given_drive, motor=motor, gearbox=gearbox, flywheel=flywheel))
    return found


@pytest.fixture(scope='module')
def designs(grid):
    return Designs.of(grid)


@pytest.fixture(scope='module')
def table(press_profile, press_parts, designs):
    return sweep_orbits(press_profile, press_parts, NOMINAL, designs)


def same_bits(one, other):
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, other))


def test_every_design_of_a_grid_is_as_the_exact_solver_says(grid, table):
    assert 0.5 < np.mean(table.found) < 1.0
    for number in range(0, len(grid), 3):
        check(grid[number], table, number)


def test_the_drive_of_document_004(press, orbit_of, press_profile, press_parts):
    flywheels = [0.0, 0.02, 0.06, 0.2]
    found = sweep_orbits(press_profile, press_parts, NOMINAL,
                         Designs.of([press(flywheel) for flywheel in flywheels]))
    expected = np.transpose([exact(orbit_of(flywheel)) for flywheel in flywheels])
    assert found.found.all()
    np.testing.assert_allclose(np.stack(but_the_force(found)[:-1]), expected[:-1], rtol=EXACT)
    np.testing.assert_allclose(found.multiplier, expected[-1], atol=EXACT)


@settings(max_examples=25, deadline=None, suppress_health_check=[
    HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(data=st.data())
def test_any_design_is_as_the_exact_solver_says(press_profile, press_parts, data):
    drive = data.draw(drives(press_profile, press_parts))
    check(drive, sweep_orbits(press_profile, press_parts, NOMINAL, Designs.of([drive])), 0)


def test_another_cam_with_dwells_and_friction():
    profile = CamProfile([
        segment('out', 90.0, 0.04, 'cycloidal'), segment('wait', 180.0, 0.0, 'dwell'),
        segment('back', 300.0, -0.04, 'cubic'), segment('rest', 360.0, 0.0, 'dwell')])
    parts = (RotatingInertia(0.05), TranslatingMass(12.0), Spring(8000.0, 0.02),
             Friction(viscous=30.0, coulomb=40.0))
    made = [CamDrive(profile, parts, KlossMotor(1500.0 * RPM, torque, 0.25, 0.003),
                     Gearbox(4.8, efficiency, 0.004), flywheel, 300.0 * RPM)
            for torque in (1.0, 15.0, 60.0) for efficiency in (1.0, 0.85)
            for flywheel in (0.005, 0.02)]
    found = sweep_orbits(profile, parts, 300.0 * RPM, Designs.of(made))
    assert found.found.any()
    for number, drive in enumerate(made):
        check(drive, found, number)


def test_a_lossless_drive_gives_the_work_of_the_load(grid, press_profile, press_parts):
    free = Designs.of([replace(drive, gearbox=replace(drive.gearbox, efficiency=1.0))
                       for drive in grid[40:60]])
    found = sweep_orbits(press_profile, press_parts, NOMINAL, free)
    work = 150.0 * (np.arccos((0.148 - 0.06) / 0.18) - np.arccos(0.148 / 0.18))
    np.testing.assert_allclose(found.motor_work[found.found], work, rtol=1e-7)


def test_between_the_weakest_motor_that_carries_the_load_and_the_next_there_is_a_clear_limit(
        press, press_profile, press_parts):
    torques = np.linspace(2.0, 12.0, 401)
    base = Designs.of([press()] * torques.size)
    found = sweep_orbits(press_profile, press_parts, NOMINAL,
                         replace(base, breakdown_torque=torques)).found
    limit = int(np.argmax(found))
    assert 0 < limit
    assert found[limit:].all()
    motor = press().motor
    find_orbit(press(motor=replace(motor, breakdown_torque=float(torques[limit]))))
    for k in (limit - 1, limit - 2):
        with pytest.raises(NoOrbitError):
            find_orbit(press(motor=replace(motor, breakdown_torque=float(torques[k]))))


def test_what_the_fast_ways_leave_open_goes_to_the_exact_solver(
        monkeypatch, press_profile, press_parts, designs, table):
    monkeypatch.setattr(sweep_module, '_EFFORTS', ())
    some = designs[20:26]
    slow = sweep_orbits(press_profile, press_parts, NOMINAL, some)
    assert slow.found.any()
    for ours, theirs in zip(but_the_force(table), but_the_force(slow)):
        both = table.found[20:26] & slow.found
        np.testing.assert_allclose(ours[20:26][both], theirs[both], rtol=2 * EXACT, atol=1e-12)


def test_what_the_motor_draws_is_more_than_what_is_left_of_it(press, press_profile, press_parts):
    found = sweep_orbits(press_profile, press_parts, NOMINAL,
                         Designs.of([press(0.06), press(0.0)]))
    np.testing.assert_allclose(found.motor_work, [76.384, 86.431], atol=5e-4)
    # by a general solver, DOP853
    np.testing.assert_allclose(found.drawn_work, [79.094, 131.97], rtol=5e-5)


@pytest.mark.parametrize('chunk', [1, 7, 50, 1000])
def test_chunks_make_no_difference_to_any_bit(press_profile, press_parts, designs, table, chunk):
    heard = []
    found = sweep(press_profile, press_parts, NOMINAL, designs, chunk=chunk,
                  tell=lambda done, total: heard.append((done, total)))
    assert same_bits(found, table)
    assert heard[-1] == (len(designs), len(designs))
    assert [done for done, _ in heard] == sorted(done for done, _ in heard)
    assert len(heard) == -(-len(designs) // chunk)


def test_threads_make_no_difference_to_any_bit(press_profile, press_parts, designs, table):
    with ThreadPoolExecutor(WORKERS) as executor:
        found = sweep(press_profile, press_parts, NOMINAL, designs, executor, chunk=20)
    assert same_bits(found, table)


def test_processes_make_no_difference_to_any_bit(press_profile, press_parts, designs, table):
    context = multiprocessing.get_context('spawn')
    with ProcessPoolExecutor(WORKERS, mp_context=context) as executor:
        found = sweep(press_profile, press_parts, NOMINAL, designs, executor, chunk=30)
    assert same_bits(found, table)


def test_no_designs_give_an_empty_table(press_profile, press_parts, designs):
    for executor in (None, ThreadPoolExecutor(1)):
        found = sweep(press_profile, press_parts, NOMINAL, designs[:0], executor)
        assert isinstance(found, OrbitTable)
        assert found.found.dtype == bool
        assert all(column.shape == (0,) for column in found)


def test_what_fails_in_a_worker_reaches_the_caller(press_profile, designs):
    context = multiprocessing.get_context('spawn')
    with (ProcessPoolExecutor(WORKERS, mp_context=context) as executor,
          pytest.raises(AttributeError, match='edges')):
        sweep(press_profile, ('no part at all',), NOMINAL, designs, executor, chunk=10)


class Lazy(Executor):
    """Fails the first task and never begins the others."""

    def __init__(self):
        self.tasks = []

    def submit(self, function, /, *args, **kwargs):
        task = Future()
        if not self.tasks:
            task.set_exception(RuntimeError('out of memory'))
        self.tasks.append(task)
        return task


def test_tasks_not_yet_begun_are_cancelled(press_profile, press_parts, designs):
    executor = Lazy()
    with pytest.raises(RuntimeError, match='out of memory'):
        sweep(press_profile, press_parts, NOMINAL, designs, executor, chunk=10)
    assert len(executor.tasks) > 1
    assert all(task.cancelled() for task in executor.tasks[1:])


def test_chunks_of_nothing_are_refused(press_profile, press_parts, designs):
    with pytest.raises(ConfigurationError) as refused:
        sweep(press_profile, press_parts, NOMINAL, designs, chunk=0)
    assert [problem.path for problem in refused.value.problems] == ['chunk']


def test_designs_are_sliced_and_built_back_into_drives(grid, designs):
    assert len(designs) == len(grid)
    part = designs[10:20]
    assert len(part) == 10
    for k in (0, 9):
        built = part.drive(k, grid[0].profile, grid[0].parts, NOMINAL)
        assert built == grid[10 + k]


def test_designs_that_make_no_drive_are_refused_all_at_once(designs):
    columns = {field.name: getattr(designs, field.name).copy() for field in fields(designs)}
    columns['ratio'][3] = 0.0
    columns['efficiency'][5] = 1.2
    columns['flywheel'][7] = -0.1
    columns['a'] = columns['a'][:-1]
    with pytest.raises(ConfigurationError) as refused:
        Designs(**columns)
    assert {problem.path for problem in refused.value.problems} == {
        'ratio[3]', 'efficiency[5]', 'flywheel[7]', 'a'}


def test_a_motor_without_a_breakdown_is_refused(press):
    class Servo:
        inertia, synchronous_speed, breakdown_slip = 0.001, 300.0, 0.1

        def torque(self, speed):
            return 0.0 * speed

        slope = torque

    with pytest.raises(ConfigurationError) as refused:
        Designs.of([press(), press(motor=Servo())])
    assert [problem.path for problem in refused.value.problems] == ['drives[1].motor']
