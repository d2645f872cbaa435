# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""package.xml, setup.py, the requirements and the imports must tell the same story."""

import ast
import importlib.util
import re
import sys
from xml.etree import ElementTree

import pytest

pytestmark = pytest.mark.timeout(60)

# Libraries whose import, registry and rosdep names differ: import -> (registry, rosdep key).
# None: rosdep has no key, so that a comment in package.xml names the library.
LIBRARIES = {
    'ezdxf': ('ezdxf', 'python3-ezdxf'),
    'lz4': ('lz4', None),
    'matplotlib': ('matplotlib', 'python3-matplotlib'),
    'mcap': ('mcap', None),
    'numpy': ('numpy', 'python3-numpy'),
    'PIL': ('pillow', 'python3-pil'),
    'rich': ('rich', 'python3-rich'),
    'rosbags': ('rosbags', 'python3-rosbags-pip'),
    'ruamel': ('ruamel.yaml', 'python3-ruamel.yaml'),
    'scipy': ('scipy', 'python3-scipy'),
    'yaml': ('PyYAML', 'python3-yaml'),
    'zstandard': ('zstandard', None),
}
# Libraries that some may leave out, by the extra of setup.py: import -> (registry, extra).
OPTIONAL = {'imageio_ffmpeg': ('imageio-ffmpeg', 'mp4')}
LAUNCH = {'launch', 'launch_ros', 'ros2launch'}


@pytest.fixture(scope='module')
def package(root):
    """Return the root element of package.xml, with its comments."""
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    return ElementTree.parse(root / 'package.xml', parser).getroot()


@pytest.fixture(scope='module')
def dependencies(package):
    """Return the names package.xml declares for running."""
    return {tag.text for kind in ('depend', 'exec_depend') for tag in package.iter(kind)}


def imported(folder):
    """Return the foreign top-level modules the files of a folder import, with one place each."""
    modules = {}
    for path in sorted(folder.rglob('*.py')):
        for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom) and not node.level:
                names = [node.module]
            else:
                continue
            for name in names:
                modules.setdefault(name.partition('.')[0], f'{path}:{node.lineno}')
    own = {'cam_motion', '__future__'}
    return {name: at for name, at in modules.items() if name not in sys.stdlib_module_names | own}


def test_package_xml_is_format_3_of_an_ament_python_package(package):
    assert package.tag == 'package' and package.get('format') == '3'
    assert package.findtext('export/build_type') == 'ament_python'
    for required in ('description', 'maintainer', 'license'):
        assert package.findtext(required).strip(), required


@pytest.mark.parametrize('field', ['name', 'version', 'license'])
def test_setup_py_agrees_with_package_xml(package, setup_arguments, field):
    assert setup_arguments[field] == package.findtext(field)


def test_every_import_of_the_package_is_declared(root, dependencies, setup_arguments):
    missing = []
    for name, place in imported(root / 'cam_motion').items():
        if name in OPTIONAL:
            library, extra = OPTIONAL[name]
            if library not in setup_arguments['extras_require'][extra]:
                missing.append(f'{place}: {name} needs {library} in the extra {extra}')
            continue
        registry, key = LIBRARIES.get(name, (None, name))
        if key is not None and key not in dependencies:
            missing.append(f'{place}: {name} needs {key} in package.xml')
        if registry is not None and registry not in setup_arguments['install_requires']:
            missing.append(f'{place}: {name} needs {registry} in setup.py')
    assert not missing, '\n'.join(missing)


def test_every_import_of_the_launch_files_is_declared(root, dependencies):
    wanted = {LIBRARIES.get(name, (None, name))[1] for name in imported(root / 'launch')}
    assert wanted <= dependencies


def test_libraries_without_a_rosdep_key_are_named_in_a_comment(package, setup_arguments):
    comments = ' '.join(node.text for node in package.iter(ElementTree.Comment))
    for registry, key in LIBRARIES.values():
        if key is None and registry in setup_arguments['install_requires']:
            assert registry in comments


def test_setup_py_requires_libraries_only_and_never_a_ros_package(setup_arguments):
    assert set(setup_arguments['install_requires']) <= {name for name, _ in LIBRARIES.values()}


def test_requirements_are_pinned_and_complete(root, setup_arguments):
    lines = (root / 'requirements.txt').read_text().splitlines()
    lines += (root / 'requirements-dev.txt').read_text().splitlines()
    pins = [line for line in lines if line and not line.startswith(('#', '-r '))]
    for pin in pins:
        assert re.fullmatch(r'[\w.-]+(\[\w+\])?==[\w.]+(; python_version [<>]=? "[\d.]+")?', pin)
    assert {re.split(r'[\[=]', pin)[0] for pin in pins} >= set(setup_arguments['install_requires'])


def test_the_wheels_bring_every_ros_package(dependencies):
    pytest.importorskip('rclpy')
    ros = {name for name in dependencies - LAUNCH if not name.startswith('python3-')}
    assert [name for name in sorted(ros) if importlib.util.find_spec(name) is None] == []
