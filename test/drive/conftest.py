# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The cam press of document 004, which the tests of the drives share."""

from functools import cache
from math import pi

from cam_motion import CamProfile, segment
from cam_motion.drive.cam_drive import CamDrive
from cam_motion.drive.document_004 import document_metrics
from cam_motion.drive.gearbox import Gearbox
from cam_motion.drive.load import Lever, RotatingInertia, Spring, TranslatingMass
from cam_motion.drive.motor import InductionMotor
from cam_motion.drive.orbit import find_orbit
from cam_motion.units import RPM
import pytest

HARMONIC = (0.0, 0.0, 0.5, 0.0, 0.5, 0.0, 0.0)
RATIO = 1421.0 / 400.0
ROTOR = 0.0028


@pytest.fixture(scope='session')
def base():
    """Give the radius of the disc plus that of the roller [m]."""
    return 0.04 + 0.012


@pytest.fixture(scope='session')
def press_profile():
    """Make the cam: simple harmonic rise of 60 mm to 150 degrees, and return."""
    return CamProfile([
        segment('rise', 150.0, 0.06, 'modified_trapezoid', fractions=HARMONIC),
        segment('return', 360.0, -0.06, 'modified_trapezoid', fractions=HARMONIC),
    ])


@pytest.fixture(scope='session')
def press_parts():
    """Make the load: disc, follower, spring, and the lever with its moment during the rise."""
    return (RotatingInertia(0.02), TranslatingMass(7.0), Spring(20000.0, 0.01),
            Lever(0.05, 0.18, 0.3 - 0.1 - 0.04 - 0.012, 150.0, (0.0, 5.0 * pi / 6.0)))


@pytest.fixture(scope='session')
def press_motor():
    """Make the motor, NM 90L-4."""
    return InductionMotor(1500.0 * RPM, 27.27, 0.315, 1.587, 1.416, ROTOR)


@pytest.fixture(scope='session')
def press(press_profile, press_parts, press_motor):
    """Make the drive; what a test gives replaces the document's choice."""
    def make(flywheel=0.06, efficiency=0.9, motor=press_motor, parts=press_parts,
             nominal_speed=400.0 * RPM):
        gearbox = Gearbox(RATIO, efficiency, (1.0 + 0.1 * RATIO) * ROTOR)
        return CamDrive(press_profile, parts, motor, gearbox, flywheel, nominal_speed)
    return make


@pytest.fixture(scope='session')
def orbit_of(press):
    """Find the periodic motion with a flywheel, once."""
    @cache
    def find(flywheel):
        return find_orbit(press(flywheel))
    return find


@pytest.fixture(scope='session')
def document_run(press, base):
    """Run the document's own simulation, once."""
    return document_metrics(press(), base)
