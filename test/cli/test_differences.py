# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Why the document's figures differ from those of the motion, in words that are true."""

import copy

from cam_motion.cli.differences import why_they_differ
import pytest

SAME = {
    'orbit': {'fluctuation_pct': 5.0, 'stability_pct': 80.0, 'running_cost_pct': 9.0,
              'min_contact_force': 700.0, 'drawn_work_per_cycle': 79.0,
              'motor_work_per_cycle': 79.0},
    'start_up': {'first_crossing_s': 0.6, 'settled_s': 0.6, 'followed_s': 3.0,
                 'min_contact_force': 500.0},
    'document': {'fluctuation_pct': 5.0, 'stability_pct': 80.0, 'running_cost_pct': 9.0,
                 'min_contact_force': 700.0, 'steady_state_time_s': 0.6},
}


def changed(**changes):
    """Change some figures, named part__figure."""
    result = copy.deepcopy(SAME)
    for name, value in changes.items():
        part, figure = name.split('__')
        result[part][figure] = value
    return result


def test_where_nothing_differs_nothing_is_explained():
    assert why_they_differ(SAME) == 'Both sets of definitions agree here.'


def test_equal_negative_forces_do_not_differ():
    result = changed(orbit__min_contact_force=-86.6, document__min_contact_force=-86.6,
                     start_up__min_contact_force=-86.6)
    assert why_they_differ(result) == 'Both sets of definitions agree here.'


@pytest.mark.parametrize(('changes', 'said'), [
    ({'document__fluctuation_pct': 6.0}, 'The fluctuation 6.000 % is read from one third'),
    ({'document__running_cost_pct': 9.5, 'document__stability_pct': 79.0},
     'The stability 79.000 % and the running cost 9.500 % are read'),
    ({'document__min_contact_force': 500.1}, '500.1 N belongs to the start-up; in periodic'),
    ({'document__min_contact_force': 650.0, 'start_up__min_contact_force': 400.0},
     'is 650.0 N in the steps of the document, 400.0 N in the start-up and 700.0 N'),
    ({'document__steady_state_time_s': 0.7}, 'in the steps of the document at 0.7000 s'),
    ({'document__steady_state_time_s': None, 'start_up__first_crossing_s': 3.8},
     'first reached at 3.8000 s, when the 3 s of the document are over'),
    ({'start_up__first_crossing_s': None}, 'is not reached within 3 s'),
    ({'start_up__settled_s': None}, 'has not settled within 3 s'),
    ({'start_up__settled_s': 0.7}, 'but lost again until 0.7000 s'),
])
def test_every_figure_that_differs_is_explained(changes, said):
    assert said in why_they_differ(changed(**changes))
