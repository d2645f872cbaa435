# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Input shaping in a machine file: the cam that comes of it, and everything that is refused."""

from cam_motion.errors import ConfigurationError
from cam_motion.io.axis import build_axis
from cam_motion.io.format_parameters import is_of_a_format
from cam_motion.io.shaping import container_of, load_of
from cam_motion.motion.profile import CamProfile
from cam_motion.motion.shaped_profile import ShapedProfile
from cam_motion.motion.shaping import KINDS, zvd
from cam_motion.units import RPM, TURN
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(40)

FEEDER = {
    'cycle': 'accumulate', 'segments': ['feed', 'wait'], 'feed.law': 'modified_trapezoid',
    'feed.end_deg': 80.0, 'feed.lift': 0.3, 'wait.end_deg': 360.0,
}
ZVD = {'kind': 'zvd', 'frequency_hz': 4.0, 'damping': 0.02, 'speed_cpm': 60.0}


def built(shaping, **more):
    """Build the feeder with shaping."""
    return build_axis('feeder', {
        **FEEDER, **more, **{f'shaping.{key}': value for key, value in shaping.items()}})


def problems_of(shaping, **more):
    """Say what is wrong, by path."""
    with pytest.raises(ConfigurationError) as caught:
        built(shaping, **more)
    return {problem.path: str(problem) for problem in caught.value.problems}


def test_the_axis_runs_the_shaped_cam():
    axis, plain = built(ZVD), build_axis('feeder', FEEDER)
    made = zvd(4.0 * TURN, 0.02)
    phi = np.linspace(0.0, 14.0, 71)
    copies = sum(a * plain.profile(phi - t * 60.0 * RPM) for a, t in zip(
        made.amplitudes, made.times))
    assert axis.profile(phi) == pytest.approx(copies, abs=1e-12)
    motion = axis.layout.motion
    assert [motion.sample(angle)[0] for angle in phi.tolist()] == pytest.approx(
        copies.tolist(), abs=1e-12)
    assert motion(phi)[0] == pytest.approx(copies, abs=1e-12)


def test_limits_are_held_against_the_shaped_curve():
    limit = {'limits.acceleration': 100.0}
    axis, plain = built(ZVD, **limit), build_axis('feeder', {**FEEDER, **limit})
    peak = abs(axis.profile.curve.peak(2).value)
    assert axis.speed_bound.omega == pytest.approx((100.0 / peak) ** 0.5, rel=1e-12)
    assert axis.speed_bound.omega > plain.speed_bound.omega


def test_several_cams_are_shaped_alike_and_kind_none_shapes_nothing():
    cams = {'cams': ['small', 'large'], **{
        f'{cam}.{key}': value for cam in ('small', 'large') for key, value in FEEDER.items()}}
    given = {**cams, **{f'shaping.{key}': value for key, value in ZVD.items()}}
    axis = build_axis('feeder', given)
    assert all(isinstance(cam, ShapedProfile) for cam in axis.layout.cams.values())
    plain = build_axis('feeder', {**given, 'shaping.kind': 'none'})
    assert all(type(cam) is CamProfile for cam in plain.layout.cams.values())
    assert load_of(plain.values).frequency == 4.0 * TURN
    assert load_of(build_axis('feeder', FEEDER).values) is None


def test_a_container_gives_the_frequency_and_the_height():
    axis = built({'kind': 'zv', 'container_width': 0.08, 'fill_height': 0.1, 'speed_cpm': 60.0})
    container = container_of(axis.values)
    assert axis.profile.filter.times[1] == pytest.approx(
        0.5 * TURN / container.frequency, rel=1e-12)
    assert load_of(axis.values).factor == container.height_factor
    cup = built({'kind': 'zv', 'container_radius': 0.04, 'fill_height': 0.1, 'speed_cpm': 60.0})
    assert cup.profile.filter.duration < axis.profile.filter.duration


@pytest.mark.parametrize('shaping, path, said', [
    ({'frequency_hz': 4.0}, 'shaping.kind', 'write kind: zvd, or kind: none'),
    ({'kind': 'zvd', 'frequency_hz': 4.0}, 'shaping.speed_cpm', 'exact at one speed only'),
    ({'kind': 'zvd', 'speed_cpm': 60.0}, 'shaping.frequency_hz', 'or container_width'),
    ({**ZVD, 'kind': 'zvx'}, 'shaping.kind', 'must be one of none, zv, zvd'),
    ({**ZVD, 'frequency_hz': -4.0}, 'shaping.frequency_hz', 'at least 0.001'),
    ({**ZVD, 'damping': 1.0}, 'shaping.damping', 'at most 0.9'),
    ({**ZVD, 'speed_cpm': 0.0}, 'shaping.speed_cpm', 'above 0'),
    ({**ZVD, 'frequency_hz': 0.01}, 'shaping.speed_cpm', 'it takes 100'),
    ({**ZVD, 'fill_height': 0.1}, 'shaping.fill_height', 'goes with a container'),
    ({**ZVD, 'container_width': 0.1, 'fill_height': 0.1}, 'shaping.container_width',
     'leave one of the two out'),
    ({'kind': 'zv', 'container_width': 0.1, 'speed_cpm': 60.0}, 'shaping.fill_height',
     'must be given with a container'),
    ({**ZVD, 'frequency_hz': 2.0, 'fit': True}, 'shaping.fit', 'spans 80 deg'),
    ({**ZVD, 'kind': 'polydyne'}, 'shaping.kind', 'polynomial_4567'),
    ({**ZVD, 'frequency': 4.0}, 'shaping.frequency', 'did you mean shaping.frequency_hz?'),
])
def test_what_cannot_be_used_is_refused_with_path_and_way_out(shaping, path, said):
    found = problems_of(shaping)
    assert list(found) == [path]
    assert said in found[path]


def test_everything_that_is_wrong_is_told_at_once():
    found = problems_of({'kind': 'zv', 'container_radius': 0.1, 'frequency_hz': 2.0},
                        unit='rad', **{'feed.lift': 'far'})
    assert list(found) == ['feed.lift', 'shaping.container_radius', 'shaping.fill_height',
                           'shaping.speed_cpm'] or set(found) == {
        'feed.lift', 'shaping.container_radius', 'shaping.fill_height', 'shaping.speed_cpm'}
    assert 'moves along a line' in problems_of(
        {'kind': 'zv', 'container_width': 0.1, 'fill_height': 0.1, 'speed_cpm': 60.0},
        unit='rad')['shaping.container_width']


def test_an_axis_that_runs_backwards_or_behind_another_is_not_shaped():
    assert 'runs forwards' in problems_of(ZVD, ratio=-1.0)['shaping.kind']
    assert 'no steady speed' in problems_of(ZVD, follows='knife')['shaping.kind']
    assert 'stands for parameters of the axis' in problems_of(
        ZVD, segments=['shaping', 'wait'])['segments']


def test_shaping_belongs_to_a_format():
    assert is_of_a_format('shaping.kind') and is_of_a_format('shaping.frequency_hz')


_EXTREMES = st.sampled_from((1e-3, 1e-2, 0.5, 4.0, 300.0, 1e5)) | st.floats(1e-3, 1e5)


@given(st.sampled_from(KINDS), _EXTREMES, st.floats(0.0, 0.9), _EXTREMES | st.floats(1e-30, 1e6),
       st.sampled_from(('modified_sine', 'polynomial_4567', 'cubic')), st.booleans())
def test_whatever_is_within_the_rules_is_shaped_or_refused(
        kind, frequency, damping, speed, law, fit):
    shaping = {'kind': kind, 'frequency_hz': frequency, 'damping': damping, 'speed_cpm': speed,
               'fit': fit}
    try:
        axis = built(shaping, **{'feed.law': law})
    except ConfigurationError as error:
        assert all(problem.path.startswith('shaping.') for problem in error.problems)
        return
    curve = axis.profile.curve
    assert np.all(np.isfinite(curve(np.linspace(0.0, TURN, 50), 2)))
    assert (curve.start, curve.end) == (0.0, TURN)
    assert axis.profile.jumps(0) == axis.profile.jumps(1) == []
    assert len(axis.profile.segment_peaks) == 2
