# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The rules of the house: who may import whom, and that everything public is documented."""

import ast
from pathlib import Path
import re
import subprocess
import sys

import pytest

pytestmark = pytest.mark.timeout(60)

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / 'cam_motion'

# io, nodes, cli -> runtime, drive, mechanism -> motion -> units, errors
RANKS = {
    'errors': 0, 'units': 0, 'motion': 1, 'runtime': 2, 'drive': 2, 'mechanism': 2,
    'io': 3, 'nodes': 4, 'cli': 5, 'start': 6, '__main__': 7,
}
SIDEWAYS = {'runtime', 'drive', 'mechanism'}  # may import each other
PUBLIC_FACE = {'errors', 'units', 'motion'}  # what cam_motion/__init__.py may offer
CORE = [part for part, rank in RANKS.items() if rank <= 2]
ROS = re.compile(r'(rclpy|rosidl_\w+|ament_index_python|\w+_(msgs|srvs|interfaces))$')
HEAVY = {'matplotlib', 'rosbags', 'mcap', 'rich'}
DOCUMENTED = ['errors', 'units', 'motion', 'runtime']


def modules(*parts):
    """Give the source files of some parts of the package."""
    for part in parts:
        folder, file = PACKAGE / part, PACKAGE / f'{part}.py'
        yield from sorted(folder.rglob('*.py')) if folder.is_dir() else [file] * file.exists()


def part_of(path):
    """Give the part of the package that a file belongs to."""
    return path.relative_to(PACKAGE).parts[0].removesuffix('.py')


def imports(tree, lazily=True):
    """Give the dotted names that a module imports; only those at its top if not lazily."""
    waiting = [tree]
    while waiting:
        for node in ast.iter_child_nodes(waiting.pop()):
            if isinstance(node, ast.Import):
                yield from (alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, 'imports are absolute'
                yield from (f'{node.module}.{alias.name}' for alias in node.names)
            elif lazily or not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                waiting.append(node)


def wrong_imports(part, names):
    """Give the imports from within the package that go the wrong way."""
    for name in names:
        package, _, rest = name.partition('.')
        if package != 'cam_motion':
            continue
        target = rest.partition('.')[0]
        if target not in RANKS:  # `from cam_motion import CamProfile`: the public face
            allowed = RANKS[part] > RANKS['motion']
        else:
            allowed = target == part or RANKS[target] < RANKS[part] or (
                {part, target} <= SIDEWAYS)
        if not allowed:
            yield name


def tree_of(path):
    """Parse a file."""
    return ast.parse(path.read_text(encoding='utf-8'))


def test_every_part_of_the_package_has_its_place():
    parts = {part_of(path) for path in PACKAGE.rglob('*.py')} - {'__init__'}
    assert parts <= set(RANKS)


@pytest.mark.parametrize('part', RANKS)
def test_imports_go_inwards_only(part):
    wrong = {str(path.relative_to(ROOT)): found for path in modules(part)
             if (found := list(wrong_imports(part, imports(tree_of(path)))))}
    assert wrong == {}


def test_the_public_face_offers_the_motion_core_only():
    names = [name for name in imports(tree_of(PACKAGE / '__init__.py'))
             if name.startswith('cam_motion.')]
    assert names and {name.split('.')[1] for name in names} <= PUBLIC_FACE


def test_only_nodes_import_ros_and_the_command_line_only_where_it_starts_nodes():
    wrong = []
    for path in PACKAGE.rglob('*.py'):
        part = part_of(path)
        if part != 'nodes':
            names = imports(tree_of(path), lazily=part != 'cli')
            wrong += [(str(path.relative_to(ROOT)), name) for name in names
                      if ROS.match(name.partition('.')[0])]
    assert wrong == []


def test_the_core_never_imports_pictures_bags_or_terminals_at_the_top():
    wrong = [(str(path.relative_to(ROOT)), name) for path in modules(*CORE)
             for name in imports(tree_of(path), lazily=False)
             if name.partition('.')[0] in HEAVY]
    assert wrong == []


def test_the_core_is_importable_without_ros_pictures_bags_and_terminals():
    names = ['.'.join(path.relative_to(ROOT).with_suffix('').parts) for path in modules(*CORE)]
    program = f"""
import importlib, re, sys
class Refuse:
    def find_spec(self, name, path=None, target=None):
        head = name.partition('.')[0]
        if head in {HEAVY!r} or re.match({ROS.pattern!r}, head):
            raise ImportError('refused: ' + name)
sys.meta_path.insert(0, Refuse())
for name in {names!r}:
    importlib.import_module(name)
import cam_motion
cam = cam_motion.CamProfile([cam_motion.segment('rest', 360.0)])
print('imported', len({names!r}), cam.sample(1.0))
"""
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True,
                          cwd=ROOT, timeout=50, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f'imported {len(names)} (0.0, 0.0, 0.0, 0.0)\n'


@pytest.mark.parametrize(('part', 'name', 'refused'), [
    ('motion', 'cam_motion.runtime.shaft', True), ('motion', 'cam_motion.errors.Problem', False),
    ('motion', 'cam_motion.CamProfile', True), ('io', 'cam_motion.CamProfile', False),
    ('runtime', 'cam_motion.drive.inverse', False), ('errors', 'cam_motion.units.TURN', True),
    ('io', 'cam_motion.nodes.line', True), ('cli', 'cam_motion.nodes.line', False),
])
def test_the_check_of_imports_can_tell_right_from_wrong(part, name, refused):
    assert list(wrong_imports(part, [name])) == [name] * refused


def test_the_check_of_imports_sees_those_inside_functions_only_when_asked():
    tree = ast.parse('import a\nif a:\n    from b import c\ndef f():\n    import d\n'
                     'class K:\n    import e\n')
    assert sorted(imports(tree)) == ['a', 'b.c', 'd', 'e']
    assert sorted(imports(tree, lazily=False)) == ['a', 'b.c', 'e']


def public(tree, inside=''):
    """Give (dotted name, node, class or None) of all public classes, functions and methods."""
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith('_'):
            yield f'{inside}{node.name}', node
            yield from public(node, f'{inside}{node.name}.')
        elif isinstance(node, ast.FunctionDef) and (
                not node.name.startswith('_') or node.name == '__call__'):
            yield f'{inside}{node.name}', node


def arguments(function):
    """Give the names of a function's arguments."""
    given = function.args
    named = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    extra = [a for a in (given.vararg, given.kwarg) if a is not None]
    return [a.arg for a in [*named, *extra] if a.arg not in ('self', 'cls')]


def documented(docstring):
    """Give the names that stand in the sections Parameters and Attributes."""
    sections = re.findall(r'^ *(?:Parameters|Attributes)\n *-+\n(.*?)(?=^ *\w+\n *-+\n|\Z)',
                          docstring, re.DOTALL | re.MULTILINE)
    for section in sections:
        for names in re.findall(r'^ *([*\w, ]+?) : ', section, re.MULTILINE):
            yield from (name.strip(' *') for name in names.split(','))


def docstring_flaws(name, node):
    """Say what a docstring lacks."""
    text = ast.get_docstring(node, clean=False)
    if not text:
        return [f'{name} has no docstring']
    found = []
    if '\n' in text and not re.match(r'\n +\S', text):
        found.append(f'{name}: the summary of a long docstring stands on its second line')
    function = node
    if isinstance(node, ast.ClassDef):
        function = next((each for each in node.body if isinstance(each, ast.FunctionDef)
                         and each.name == '__init__'), None)
        if function is None or any(base.id.endswith('Error') for base in node.bases
                                   if isinstance(base, ast.Name)) and not arguments(function):
            return found
    missing = [a for a in arguments(function) if a not in set(documented(text))]
    return found + [f'{name}: the argument {a} is not documented' for a in missing]


def test_everything_public_is_documented_with_each_argument():
    found, seen = [], 0
    for path in modules(*DOCUMENTED):
        for name, node in public(tree_of(path)):
            seen += 1
            found += [f'{path.relative_to(ROOT)}: {flaw}' for flaw in docstring_flaws(name, node)]
    assert found == []
    assert seen > 60


@pytest.mark.parametrize(('source', 'flaws'), [
    ('def f(): pass', ['f has no docstring']),
    ('def f(x):\n    """Do."""', ['f: the argument x is not documented']),
    ('def f(x, *rest):\n    """\n    Do.\n\n    Parameters\n    ----------\n    x : int\n'
     '        One.\n    *rest : int\n        More.\n\n    """', []),
    ('def f():\n    """Do.\n\n    More.\n    """',
     ['f: the summary of a long docstring stands on its second line']),
    ('class C:\n    """A class."""\n    def __init__(self, a): pass',
     ['C: the argument a is not documented']),
    ('class C:\n    """A class."""\n    def m(self): pass', ['C.m has no docstring']),
    ('def _f(): pass', []),
])
def test_the_check_of_docstrings_can_tell_right_from_wrong(source, flaws):
    found = [flaw for name, node in public(ast.parse(source))
             for flaw in docstring_flaws(name, node)]
    assert found == flaws
