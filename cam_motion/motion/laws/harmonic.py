# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Laws that are one stretch of a few sinusoids with a straight line."""

from __future__ import annotations

import math

from cam_motion.motion.laws.inflection import INFLECTION, with_inflection
from cam_motion.motion.laws.law import register
from cam_motion.motion.piece import Piece, Wave
from cam_motion.motion.piecewise import Piecewise
from cam_motion.units import TURN


@register('cycloidal', 'sinusoidal acceleration (inclined sine, Bestehorn)',
          'document 002, cycloidal', INFLECTION)
def cycloidal(inflection: float = 0.5) -> Piecewise:
    """
    Build the cycloidal law, s = xi - sin(2 pi xi) / (2 pi).

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1; velocity and acceleration are zero at both ends.

    """
    return with_inflection(_odd_harmonics((1, 1.0)), inflection)


@register('simple_harmonic', 'half a cosine (simple sine line); its acceleration steps at a dwell',
          'VDI 2143 sheet 1, simple sine line', INFLECTION)
def simple_harmonic(inflection: float) -> Piecewise:
    """
    Build the simple harmonic law, s = (1 - cos(pi xi)) / 2.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1. Its acceleration is pi²/2 at the start and -pi²/2 at the end.

    """
    curve = Piecewise(0.0, [Piece(1.0, (0.5,), (Wave(math.pi, -0.5, 0.0),))])
    return with_inflection(curve, inflection)


@register('double_harmonic', 'cosine and its double, from rest to a turn',
          'H. A. Rothbart (ed.), Cam Design Handbook (2004), double harmonic')
def double_harmonic() -> Piecewise:
    """
    Build the double harmonic law, s = (1 - cos(pi xi)) / 2 - (1 - cos(2 pi xi)) / 8.

    Returns
    -------
    Piecewise
        The rise from 0 to 1. It starts at rest and ends with the acceleration -pi², for a cam
        that turns there.

    """
    return Piecewise(0.0, [Piece(
        1.0, (0.375,), (Wave(math.pi, -0.5, 0.0), Wave(TURN, 0.125, 0.0)))])


@register('double_harmonic_return', 'the double harmonic backwards, from a turn to rest',
          'H. A. Rothbart (ed.), Cam Design Handbook (2004), double harmonic')
def double_harmonic_return() -> Piecewise:
    """
    Build the double harmonic law that ends at rest, s = 1 - d(1 - xi) with d the double harmonic.

    Returns
    -------
    Piecewise
        The rise from 0 to 1. It starts with the acceleration pi² and ends at rest.

    """
    return Piecewise(0.0, [Piece(
        1.0, (0.625,), (Wave(math.pi, -0.5, 0.0), Wave(TURN, -0.125, 0.0)))])


@register('gutman_13', 'first and third harmonic: little acceleration at finite jerk',
          'A. S. Gutman, To avoid vibration try this new cam profile, '
          'Product Engineering (25 December 1961)', INFLECTION)
def gutman_13(inflection: float) -> Piecewise:
    """
    Build Gutman's law of two harmonics, 15/16 and 1/48 over 2 pi.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    Notes
    -----
    The peak acceleration is 5.1302; books that print 5.15 have rounded it.

    """
    return with_inflection(_odd_harmonics((1, 15.0 / 16.0), (3, 1.0 / 48.0)), inflection)


@register('freudenstein_13',
          'first and third harmonic: less jerk, more acceleration than gutman_13',
          'F. Freudenstein, On the dynamics of high-speed cam profiles, '
          'Int. J. Mech. Sci. 1 (1960)', INFLECTION)
def freudenstein_13(inflection: float) -> Piecewise:
    """
    Build Freudenstein's law of two harmonics, 27/28 and 1/84 over 2 pi.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    """
    return with_inflection(_odd_harmonics((1, 27.0 / 28.0), (3, 1.0 / 84.0)), inflection)


@register('freudenstein_135', 'first, third and fifth harmonic: less acceleration still',
          'F. Freudenstein, On the dynamics of high-speed cam profiles, '
          'Int. J. Mech. Sci. 1 (1960)', INFLECTION)
def freudenstein_135(inflection: float) -> Piecewise:
    """
    Build Freudenstein's law of three harmonics, 1, 1/54 and 1/1250 times 1125/1192 over 2 pi.

    Parameters
    ----------
    inflection : float
        Share of the span that accelerates [-].

    Returns
    -------
    Piecewise
        The rise from 0 to 1, at rest at both ends.

    """
    alpha = 1125.0 / 1192.0
    return with_inflection(
        _odd_harmonics((1, alpha), (3, alpha / 54.0), (5, alpha / 1250.0)), inflection)


def _odd_harmonics(*amplitudes: tuple[int, float]) -> Piecewise:
    """Build s = xi - sum of b_k sin(2 pi k xi) / (2 pi) from pairs (k, b_k)."""
    waves = tuple(Wave(k * TURN, 0.0, -b / TURN) for k, b in amplitudes)
    return Piecewise(0.0, [Piece(1.0, (0.0, 1.0), waves)])
