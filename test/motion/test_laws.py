# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""A walk through the registry: whoever registers a law answers for its identities."""

import math

from cam_motion.errors import ConfigurationError
from cam_motion.motion.laws import LAWS, LawType, make_law
from cam_motion.motion.piece import Piece
from cam_motion.motion.piecewise import Piecewise
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
import pytest

pytestmark = pytest.mark.timeout(60)

ROUNDING = 1e-12
GRID = 2001  # points on each piece
GRID_MISSES = 1e-5  # what a grid that fine may miss of a smooth peak (relative)
SHORTEST = 1e-9  # stretch in which differences still say something
GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(40)


def dense(curve, order):
    """Give a derivative on a dense grid, both sides of each joint included."""
    return np.concatenate([piece(np.linspace(0.0, piece.length, GRID))
                           for piece in curve.differentiated(order).pieces])


def derivative_flaws(law):
    """Compare each derivative with differences of the one before, inside the pieces."""
    for order in (1, 2, 3):
        below, above = (abs(law.curve.peak(n).value) for n in (order - 1, order + 2))
        for begin, end in zip(law.curve.breaks, law.curve.breaks[1:]):
            if end - begin < SHORTEST:
                continue
            h = 1e-4 * (end - begin)
            xi = np.linspace(begin + 2.0 * h, end - 2.0 * h, 21)
            bound = h * h / 6.0 * above + 10.0 * ROUNDING * (below + 1.0) / h
            difference = (law(xi + h, order - 1) - law(xi - h, order - 1)) / (2.0 * h)
            if np.max(np.abs(law(xi, order) - difference)) > bound:
                yield f'derivative {order} is not the slope of derivative {order - 1}'
                break


def coefficient_flaws(law):
    """Compare the coefficients with a dense grid: never below it, and hardly above."""
    curve, found = law.curve, law.coefficients
    grid = {name: np.abs(dense(curve, n)).max()
            for n, name in ((1, 'cv'), (2, 'ca'), (3, 'cj_inside'))}
    grid['power'] = np.abs(dense(curve, 1) * dense(curve, 2)).max()
    grid['rms_acceleration'] = curve.rms(2)
    for name, value in grid.items():
        coefficient = getattr(found, name)
        if math.isinf(coefficient):
            if not (name != 'cv' and (curve.jumps(1) or any(curve.end_values(1)))):
                yield f'{name} is infinite without a step of the velocity'
        elif not value * (1.0 - ROUNDING) <= coefficient <= value * (1.0 + GRID_MISSES):
            yield f'{name} is {coefficient}, on a grid it is {value}'
    if found.cj not in (found.cj_inside, math.inf):
        yield 'cj is neither infinite nor the largest jerk inside'


def flaws(law_type: LawType, **parameters) -> list[str]:
    """Say everything that is wrong with a registered law."""
    found = [f'it has no {word}' for word in ('name', 'summary', 'source')
             if not getattr(law_type, word).strip()]
    if not (law_type.build.__doc__ or '').strip():
        found.append('its builder has no docstring')
    try:
        law = make_law(law_type.name, **parameters)
        top = 0.0 if law_type.name == 'dwell' else 1.0
        if law(0.0) != pytest.approx(0.0, abs=ROUNDING):
            found.append('s(0) is not 0')
        if law(1.0) != pytest.approx(top, abs=ROUNDING):
            found.append('s(1) is not 1')
        if law.curve.jumps(0):
            found.append('the position steps')
        if law.curve.extremes(1)[0].value < -ROUNDING * abs(law.curve.peak(1).value):
            found.append('it turns back')
        area = sum(0.5 * (b - a) * float(GAUSS_WEIGHTS @ law(a + 0.5 * (b - a) * (
            GAUSS_NODES + 1.0), 1)) for a, b in zip(law.curve.breaks, law.curve.breaks[1:]))
        if area != pytest.approx(top, abs=1e-11):
            found.append(f'the velocity integrates to {area}')
        found += [*derivative_flaws(law), *coefficient_flaws(law)]
    except (AttributeError, TypeError) as error:
        found.append(f'it is not an exact curve: {error}')
    return found


@pytest.mark.parametrize('name', LAWS)
def test_every_registered_law_keeps_every_identity(name):
    assert flaws(LAWS[name]) == []


@pytest.mark.parametrize('name', LAWS)
def test_every_registered_law_is_entered_under_its_own_name(name):
    assert LAWS[name].name == name == name.lower().replace(' ', '_')


class OnlyPositions:
    """A curve that knows nothing but positions."""

    def __call__(self, xi, order=0):
        """Give the position, whatever order is asked for."""
        return np.asarray(xi, dtype=float)


class CrookedDerivative(Piece):
    """A piece whose derivative is wrong."""

    derivative = Piece(1.0, (0.9, 0.2))


BROKEN = {
    'no source': (LawType('x', 'a law', ' ', (), LAWS['cubic'].build), 'no source'),
    'no summary': (LawType('x', '', 'book', (), LAWS['cubic'].build), 'no summary'),
    'no derivatives': (LawType('x', 'a', 'b', (), OnlyPositions), 'not an exact curve'),
    'wrong derivatives': (
        LawType('x', 'a', 'b', (), lambda: Piecewise(0.0, [CrookedDerivative(1.0, (0.0, 1.0))])),
        'derivative 1 is not the slope'),
    'misses one': (
        LawType('x', 'a', 'b', (), lambda: Piecewise(0.0, [Piece(1.0, (0.0, 0.9))])),
        's(1) is not 1'),
    'does not start at zero': (
        LawType('x', 'a', 'b', (), lambda: Piecewise(0.0, [Piece(1.0, (0.1, 0.9))])),
        's(0) is not 0'),
    'steps': (
        LawType('x', 'a', 'b', (), lambda: Piecewise(0.0, [Piece(0.5), Piece(0.5, (0.5, 1.0))])),
        'the position steps'),
    'turns back': (
        LawType('x', 'a', 'b', (), lambda: Piecewise(0.0, [Piece(1.0, (0.0, -1.0, 2.0))])),
        'it turns back'),
}


@pytest.mark.parametrize('case', BROKEN)
def test_the_walk_refuses_a_broken_law(case, monkeypatch):
    law_type, complaint = BROKEN[case]
    monkeypatch.setitem(LAWS, 'x', law_type)
    assert any(complaint in flaw for flaw in flaws(law_type))


def test_the_walk_refuses_wrong_coefficients(monkeypatch):
    monkeypatch.setattr(Piecewise, 'peak_power', lambda curve: curve.peak(1))
    assert any(flaw.startswith('power is') for flaw in flaws(LAWS['cubic']))


percent = st.integers(0, 100).map(lambda n: n / 100.0)
shares = st.lists(st.integers(0, 20), min_size=7, max_size=7).filter(
    lambda n: sum(n[:3]) > 0 and sum(n[4:]) > 0)


@given(percent.filter(lambda share: 0.0 < share < 1.0))
def test_constant_acceleration_keeps_the_identities_at_any_split(ramp_up):
    assert flaws(LAWS['constant_acceleration'], ramp_up=ramp_up) == []


@given(percent, percent)
def test_trapezoidal_velocity_keeps_the_identities_or_is_refused(ramp_up, ramp_down):
    if round(100 * (ramp_up + ramp_down)) > 100:
        with pytest.raises(ConfigurationError, match='at most 1'):
            make_law('trapezoidal_velocity', ramp_up=ramp_up, ramp_down=ramp_down)
        return
    assert flaws(LAWS['trapezoidal_velocity'], ramp_up=ramp_up, ramp_down=ramp_down) == []


def test_ramps_that_fill_the_span_leave_no_stretch_between_them():
    curve = make_law('trapezoidal_velocity', ramp_up=0.94, ramp_down=0.06).curve
    assert curve.breaks == (0.0, 0.94, 1.0)


@given(shares)
def test_the_modified_trapezoid_keeps_the_identities_with_any_stages(parts):
    fractions = [part / sum(parts) for part in parts]
    assert flaws(LAWS['modified_trapezoid'], fractions=fractions) == []
    law = make_law('modified_trapezoid', fractions=fractions)
    assert law.curve.end_values(1) == pytest.approx((0.0, 0.0), abs=ROUNDING)
    assert law.curve.jumps(1) == []
