# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Filters over a cam: superposition, zero residual where it is promised, smoothness, refusals."""

import math

from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import Boundary, LAWS, make_law
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.segment import segment
from cam_motion.motion.shaped_profile import movements, ShapedProfile, smooth_laws
from cam_motion.motion.shaping import amplification, ei, KINDS, make_filter, Polydyne, zv, zvd
from cam_motion.motion.shaping_effect import Effect, Load, MovementEffect
from cam_motion.motion.slosh import Container, GRAVITY
from cam_motion.motion.superposition import cut, superposed, window
from cam_motion.motion.vibration import residual_amplitude, Response
from cam_motion.units import RPM, TURN
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import jvp

pytestmark = pytest.mark.timeout(40)

ROUNDING = 1e-12
SHAPERS = [kind for kind in KINDS if kind != 'polydyne']
STANDING = (Boundary.REST, Boundary.TURN)
RUNNING = [name for name, law in LAWS.items() if name != 'dwell' and not law.any_ends
           and all(end in STANDING for end in make_law(name).ends)]

laws = st.sampled_from(RUNNING)
dampings = st.floats(0.0, 0.3)
# a filter from a hundredth of a turn to one and a half at 60 cycles/min
frequencies = st.floats(0.7, 120.0).map(lambda hertz: hertz * TURN)
SPEED = 60.0 * RPM


def feeder(law='modified_trapezoid', lift=0.3):
    """Give a belt that moves and waits."""
    return CamProfile([segment('feed', 80.0, lift, law), segment('wait', 360.0)], True)


def knife(law='modified_sine'):
    """Give an axis that goes forth and back."""
    return CamProfile([
        segment('wait', 30.0), segment('cut', 110.0, 0.08, law), segment('hold', 200.0),
        segment('back', 290.0, -0.08, law), segment('rest', 360.0)])


@given(st.lists(st.floats(-3.0, 3.0), max_size=8), st.floats(0.0, 1.0), st.floats(0.01, 1.0))
def test_a_cut_piece_is_the_same_function(coefficients, low, length):
    piece = Piece(2.0, tuple(coefficients), (Wave(5.0, 0.3, -0.7), Wave(11.0, 0.0, 0.2)))
    u = np.linspace(0.0, length, 9)
    assert cut(piece, low, low + length)(u) == pytest.approx(piece(low + u), abs=ROUNDING)


@given(laws, st.floats(-20.0, 20.0), st.floats(0.01, 9.0))
def test_a_window_is_the_periodic_curve(law, low, length):
    cam = feeder(law)
    x = np.linspace(low, low + length, 41)
    part = window(cam.curve, cam.advance, low, low + length)
    assert (part.start, part.end) == (low, low + length)
    assert part(x) == pytest.approx(cam(x), abs=1e-11)
    assert all(piece.length > 0.0 for piece in part.pieces)


def test_superposed_curves_add_up_and_waves_of_one_frequency_become_one():
    one = Piecewise(0.0, [Piece(0.4, (1.0,)), Piece(0.6, (2.0, 1.0), (Wave(3.0, 1.0, 0.0),))])
    other = Piecewise(0.0, [Piece(0.7, (), (Wave(3.0, 0.5, 1.0),)), Piece(0.3, (0.0, 0.0, 5.0))])
    both = superposed([(0.25, one), (2.0, other)])
    x = np.linspace(0.0, 1.0, 101)
    assert both(x) == pytest.approx(0.25 * one(x) + 2.0 * other(x), abs=ROUNDING)
    assert both.breaks == pytest.approx([0.0, 0.4, 0.7, 1.0])
    assert max(len(piece.waves) for piece in both.pieces) == 1


@given(st.sampled_from(SHAPERS), frequencies, dampings)
def test_impulses_are_positive_and_sum_to_one(kind, frequency, damping):
    made = make_filter(kind, frequency, damping)
    assert math.fsum(made.amplitudes) == pytest.approx(1.0, abs=4e-16)
    assert min(made.amplitudes) >= 0.0
    assert made.times[0] == 0.0 and list(made.times) == sorted(made.times)


@given(frequencies, dampings)
def test_zero_vibration_is_zero_and_its_derivatives_where_promised(frequency, damping):
    step = 1e-4
    left = {}
    for order, kind in enumerate(SHAPERS[:3], start=1):
        made = make_filter(kind, frequency, damping)
        assert amplification(made, 1.0, frequency, damping) == pytest.approx(0.0, abs=ROUNDING)
        left[order] = float(amplification(made, 1.0 + step, frequency, damping))
    # a zero of that order: what is left is the power of the step (its factor is about pi/2)
    for order, value in left.items():
        assert value ** (1.0 / order) == pytest.approx(math.pi / 2.0 * step, rel=0.5)


@given(frequencies, st.floats(0.0, 0.05), st.floats(0.01, 0.1))
def test_extra_insensitive_leaves_its_tolerance_and_little_around(frequency, damping, tolerance):
    made = ei(frequency, damping, tolerance)
    assert float(amplification(made, 1.0, frequency, damping)) == pytest.approx(
        tolerance, rel=1e-9)
    narrow = zvd(frequency, damping)

    def width(filtered):
        ratio = np.linspace(0.3, 1.7, 2001)
        return np.count_nonzero(
            amplification(filtered, ratio, frequency, damping) <= tolerance * 1.05)
    assert width(made) > 1.3 * width(narrow)


def test_known_shapers():
    assert zv(TURN).amplitudes == (0.5, 0.5) and zv(TURN).times == (0.0, 0.5)
    assert zvd(TURN).amplitudes == (0.25, 0.5, 0.25)
    assert ei(TURN, 0.0, 0.05).amplitudes == pytest.approx((0.2625, 0.475, 0.2625), rel=1e-12)
    decay = math.exp(-0.1 * math.pi / math.sqrt(0.99))
    assert zv(3.0, 0.1).amplitudes == pytest.approx((1 / (1 + decay), decay / (1 + decay)))
    assert zv(3.0, 0.1).times[1] == pytest.approx(math.pi / (3.0 * math.sqrt(0.99)))


@given(laws, st.sampled_from((feeder, knife)), st.sampled_from(SHAPERS), frequencies, dampings)
def test_a_shaped_cam_is_the_sum_of_delayed_copies(law, make, kind, frequency, damping):
    cam, made = make(law), make_filter(kind, frequency, damping)
    shaped = ShapedProfile(cam, made, SPEED)
    phi = np.linspace(-8.0, 15.0, 61)
    copies = [(weight, cam(phi - time * SPEED)) for weight, time in zip(
        made.amplitudes, made.times)]
    assert shaped(phi) == pytest.approx(sum(w * y for w, y in copies), abs=1e-11)
    for angle in phi[::20].tolist():
        assert shaped.sample(angle)[:3] == pytest.approx(
            [float(shaped(angle, order)) for order in range(3)], abs=1e-9)


@given(laws, st.sampled_from(SHAPERS), frequencies, dampings)
def test_a_shaped_cam_stays_periodic_and_as_smooth(law, kind, frequency, damping):
    cam = feeder(law)
    shaped = ShapedProfile(cam, make_filter(kind, frequency, damping), SPEED)
    smooth = next((order for order in range(4) if cam.jumps(order)), 4)
    for order in range(smooth):
        assert shaped.jumps(order) == []
    for order in range(1, 3):  # an average is nowhere larger
        assert abs(shaped.curve.peak(order).value) <= abs(
            cam.curve.peak(order).value) * (1.0 + 1e-9)
    assert shaped.advance == cam.advance
    assert shaped(3.0 + TURN) == pytest.approx(shaped(3.0) + cam.advance, abs=ROUNDING)
    assert shaped.curve.end == TURN and len(shaped.parts) == len(shaped.segments)


def test_uniform_motion_is_only_delayed():
    cam = CamProfile([segment('run', 360.0, 0.5, 'constant_velocity')], accumulate=True)
    made = zvd(4.0 * TURN, 0.05)
    shaped = ShapedProfile(cam, made, SPEED)
    late = sum(a * t for a, t in zip(made.amplitudes, made.times)) * SPEED
    phi = np.linspace(0.0, 12.0, 49)
    assert shaped(phi) == pytest.approx(cam(phi - late), abs=ROUNDING)
    assert shaped(phi, 1) == pytest.approx(cam(phi, 1), rel=ROUNDING)


@pytest.mark.parametrize('kind', SHAPERS[:3])
@given(law=laws, frequency=st.floats(6.0, 60.0).map(lambda hertz: hertz * TURN),
       damping=dampings)
def test_nothing_is_left_behind_the_shaped_movement(kind, law, frequency, damping):
    cam, made = feeder(law), make_filter(kind, frequency, damping)
    shaped = ShapedProfile(cam, made, SPEED)
    end = cam.segments[0].end + made.duration * SPEED
    nu = frequency / SPEED
    before = residual_amplitude(cam.parts[0], nu, damping)
    after = residual_amplitude(window(shaped.curve, shaped.advance, 0.0, end), nu, damping)
    assert after <= ROUNDING
    assert before > 1e-6 or law in ('polynomial_6_to_11', 'polynomial_5_to_9') or before < 0.1
    beyond = Response(window(shaped.curve, shaped.advance, 0.0, end), nu, damping)
    assert beyond(np.linspace(end, end + 1.0, 9)) == pytest.approx(np.zeros(9), abs=ROUNDING)


@given(laws, st.sampled_from(KINDS), st.floats(8.0, 60.0), st.floats(0.0, 0.1),
       st.floats(0.5, 1.8), st.sampled_from((-0.2, -0.1, 0.0, 0.1, 0.2)))
def test_the_residual_at_other_speeds_and_frequencies_is_that_of_the_shaped_curve(
        law, kind, hertz, damping, pace, error):
    cam, load = feeder(law), Load(hertz * TURN, damping, 1.7)
    try:
        shaped = ShapedProfile(cam, make_filter(kind, load.frequency, damping), SPEED)
    except ConfigurationError:
        assert kind == 'polydyne' and law not in smooth_laws()
        return
    effect = Effect(shaped, load, SPEED).movements[0]
    end = cam.segments[0].end + shaped.filter.duration * SPEED
    nu = load.frequency * (1.0 + error) / (SPEED * pace)
    curve = window(shaped.curve, shaped.advance, 0.0, end)
    assert float(effect.residual(SPEED * pace, error)) == pytest.approx(
        1.7 * float(residual_amplitude(curve, nu, damping)), rel=1e-6, abs=1e-11)
    assert float(effect.residual(SPEED * pace, error, shaped=False)) == pytest.approx(
        1.7 * float(residual_amplitude(cam.parts[0], nu, damping)), rel=1e-9, abs=ROUNDING)


@pytest.mark.parametrize('law', ['polynomial_4567', 'polynomial_5_to_9', 'polynomial_6_to_11'])
def test_behind_the_polydyne_command_the_load_moves_along_the_cam(law):
    cam, load = knife(law), Load(9.0 * TURN, 0.04)
    shaped = ShapedProfile(cam, Polydyne(load.frequency, load.damping), SPEED)
    assert shaped.jumps(0) == shaped.jumps(1) == []
    # x'' + 2 zeta nu x' + nu² x = nu² c with the damper on the frame: x = y
    nu = load.frequency / SPEED
    phi = np.linspace(0.0, TURN, 181)
    force = cam(phi, 2) / nu ** 2 + 2.0 * load.damping / nu * cam(phi, 1) + cam(phi)
    assert shaped(phi) == pytest.approx(force, abs=ROUNDING)
    for effect in Effect(shaped, load, SPEED).movements:
        assert float(effect.residual(SPEED)) == pytest.approx(0.0, abs=ROUNDING)
        assert effect.response(SPEED).residual == pytest.approx(0.0, abs=1e-11)
    assert smooth_laws()[:1] == ('polynomial_4567',) and law in smooth_laws()


@pytest.mark.parametrize('law, what', [('modified_sine', 'jerk'), ('cubic', 'acceleration')])
def test_a_cam_too_rough_for_the_polydyne_command_is_refused(law, what):
    with pytest.raises(ConfigurationError) as caught:
        ShapedProfile(knife(law), Polydyne(50.0), SPEED)
    [problem] = caught.value.problems
    assert problem.path == 'shaping.kind'
    assert f'the {what} of the cam steps at 30 deg' in problem.rule
    assert 'polynomial_4567' in problem.hint


def test_movements_join_segments_and_pass_the_seam():
    assert [(m.segments, round(m.start, 9), round(m.end, 9)) for m in movements(knife())] == [
        (('cut',), 0.523598776, 1.919862177), (('back',), 3.490658504, 5.061454831)]
    joined = CamProfile([
        segment('down', 60.0, -0.1, 'cubic'), segment('low', 200.0),
        segment('up', 300.0, 0.05, 'cubic'), segment('on', 360.0, 0.05, 'cubic')])
    [each] = movements(joined)
    assert each.segments == ('up', 'on', 'down')
    assert (each.start, each.end) == pytest.approx((math.radians(200.0), math.radians(420.0)))


def test_a_movement_made_to_fit_ends_where_its_segment_does():
    made = zvd(10.0 * TURN, 0.02)
    cam = knife()
    late, fit = (ShapedProfile(cam, made, SPEED, fit) for fit in (False, True))
    for segment_, part in zip(fit.segments, fit.parts):
        ends = part.end_values(1)
        assert ends == pytest.approx((0.0, 0.0), abs=ROUNDING)
        if segment_.is_dwell:
            assert part.peak(1).value == pytest.approx(0.0, abs=ROUNDING)
    assert abs(late.parts[2].peak(1).value) > 1e-3  # it still moves in the dwell behind
    load = Load(10.0 * TURN, 0.02)
    for effect in Effect(fit, load, SPEED).movements:
        assert float(effect.residual(SPEED)) == pytest.approx(0.0, abs=ROUNDING)
        assert effect.response(SPEED).residual == pytest.approx(0.0, abs=ROUNDING)
    assert abs(fit.curve.peak(2).value) > abs(late.curve.peak(2).value)


def test_a_movement_too_short_to_fit_is_refused_with_the_figures():
    with pytest.raises(ConfigurationError) as caught:
        ShapedProfile(knife(), zv(2.0 * TURN), SPEED, fit=True)
    assert [problem.path for problem in caught.value.problems] == ['shaping.fit'] * 2
    assert 'cut spans 80 deg, the shaper takes 90 deg' in caught.value.problems[0].rule


def test_a_dwell_in_which_the_shaped_cam_moves_has_peaks():
    cam = feeder('cubic')
    shaped = ShapedProfile(cam, zv(3.0 * TURN), SPEED)
    feed, wait = shaped.segment_peaks
    assert cam.segment_peaks[1].velocity.value == 0.0 < abs(wait.velocity.value)
    assert math.isinf(wait.jerk.value) and math.isinf(feed.jerk.value)
    assert abs(wait.velocity.value) == pytest.approx(
        np.max(np.abs(shaped(np.linspace(1.4, TURN, 20001)[:-1], 1))), rel=1e-6)


def test_slosh_in_a_box_and_in_a_cylinder():
    box = Container(0.1, width=0.08)
    wave = math.pi / 0.08
    assert box.frequency ** 2 == pytest.approx(GRAVITY * wave * math.tanh(0.1 * wave))
    assert box.pendulum_length * box.frequency ** 2 == pytest.approx(GRAVITY)
    root = brentq(lambda x: jvp(1, x), 1.0, 3.0, xtol=1e-15)
    glass = Container(0.1, radius=0.04)
    assert glass.frequency ** 2 == pytest.approx(
        GRAVITY * root / 0.04 * math.tanh(0.1 * root / 0.04), rel=1e-12)
    # a steady acceleration a tilts the first mode by these shares of a/g times half the width
    for container, half, share in ((box, 0.04, 8.0 / math.pi ** 2),
                                   (glass, 0.04, 2.0 / (root ** 2 - 1.0))):
        height = container.height_factor / container.frequency ** 2 * GRAVITY
        assert height == pytest.approx(share * half, rel=1e-12)
        assert 0.0 < container.moving_share < 1.0
    # shallow water: waves run at sqrt(g h), and all of it moves but the higher modes
    shallow = Container(1e-4, width=1.0)
    assert shallow.frequency == pytest.approx(math.pi * math.sqrt(GRAVITY * 1e-4), rel=1e-6)
    assert shallow.moving_share == pytest.approx(8.0 / math.pi ** 2, rel=1e-6)


def test_the_modes_of_a_box_add_up_to_the_tilted_surface():
    # height factors of the odd modes: 4/(n pi) tanh; statically they sum to half the width · a/g
    width, depth = 0.08, 0.1
    modes = [Container(depth, width=width / n) for n in range(1, 40001, 2)]
    total = sum(c.height_factor / n / c.frequency ** 2
                for n, c in zip(range(1, 40001, 2), modes))
    assert total == pytest.approx(width / 2.0 / GRAVITY, rel=1e-4)


def test_resonance_of_the_cycle_is_told():
    cam = feeder()
    assert math.isinf(Effect(cam, Load(3.0 * SPEED), SPEED).repeated_peak)
    calm = Effect(cam, Load(3.0 * SPEED, 0.05), SPEED).repeated_peak
    assert math.isfinite(calm) and calm > MovementEffect(
        cam, movements(cam)[0], Load(3.0 * SPEED, 0.05)).response(SPEED).peak.value


def test_a_law_between_two_dwells_is_what_smoothness_is_judged_by():
    assert set(smooth_laws()) == {'polynomial_4567', 'polynomial_5_to_9', 'polynomial_6_to_11'}
    assert make_law('cycloidal').curve.end_values(3)[0] > 1.0
