# cam_motion without a ROS installation: everything runs from .venv/, which is built on demand.
# On a machine with ROS 2 Jazzy, `colcon build` in a workspace does the same job.

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help venv demo test bench lint clean distclean

VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.cam_motion
LOG := build/venv.log

# ---- Interpreter: the first one the Jazzy wheels exist for --------------------------------------
SUPPORTED := import platform as p, sys; libc, release = p.libc_ver(); \
  sys.exit(not ((3, 10) <= sys.version_info[:2] <= (3, 13) and libc == "glibc" and \
  [int(n) for n in release.split(".")] >= [2, 28] and \
  (p.python_implementation(), p.system(), p.machine()) == ("CPython", "Linux", "x86_64")))
CANDIDATES := $(if $(PYTHON),$(PYTHON),python3.13 python3.12 python3.11 python3.10 python3)
find-python = $(shell for p in $(CANDIDATES); do \
  $$p -c '$(SUPPORTED)' >/dev/null 2>&1 && { echo $$p; break; }; done)
NO_WHEELS = The ROS 2 Jazzy wheels need CPython 3.10-3.13 on x86-64 Linux with glibc 2.28; found \
  none among $(CANDIDATES) ($(shell uname -sm)). With ROS 2 Jazzy sourced, `colcon build` does it

# ---- Surroundings of everything run from .venv ---------------------------------------------------
# A sourced ROS installation or another environment with the wheels must not leak in.
unexport PYTHONPATH PYTHONHOME LD_LIBRARY_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
export AMENT_PREFIX_PATH := $(CURDIR)/$(VENV)
export RMW_IMPLEMENTATION := rmw_fastrtps_cpp
export ROS_AUTOMATIC_DISCOVERY_RANGE := LOCALHOST
export ROS_LOG_DIR ?= $(CURDIR)/build/ros_log
# A domain of our own, unless one is set: 10 to 99 by process number.
ifndef ROS_DOMAIN_ID
export ROS_DOMAIN_ID := $(shell echo $$(( $$$$ % 90 + 10 )))
endif

MACHINE := cutting_machine
CHECK_MANIFEST := from catkin_pkg.package import parse_package as parse; complaints = []; \
  parse('package.xml', warnings=complaints); assert not complaints, complaints
SOURCES := $(wildcard cam_motion benchmarks examples launch test)

help:  ## this list
	@echo 'cam_motion: timing diagrams in YAML become a synchronised machine. Targets:'
	@sed -n 's/^\([a-z]*\):.*  ## \(.*\)/  make \1@\2/p' Makefile | awk -F@ '{printf "%-18s%s\n", $$1, $$2}'
	@echo 'PYTHON=/path/to/python chooses the interpreter .venv/ is built with.'

demo: $(STAMP)  ## run the cutting machine for 10 s; bag, report and pictures go to out/
	@rm -rf out/$(MACHINE)
	@mkdir -p out
	$(BIN)/cam_motion line config/$(MACHINE).yaml --seconds 10 --record out/$(MACHINE) </dev/null
	$(BIN)/cam_motion report out/$(MACHINE) --output out
	$(BIN)/cam_motion plot config/$(MACHINE).yaml --output out

test: $(STAMP)  ## run all tests (ARGS='test/motion -x' runs those only)
	$(BIN)/python -m pytest $(or $(ARGS),-n 2 --dist worksteal test)

bench: $(STAMP)  ## measure speed next to the usual alternatives
	$(BIN)/python -m benchmarks $(ARGS)

lint: $(STAMP)  ## check style, docstrings, types and package.xml
	@failed=; check() { echo "$$*"; "$$@" || failed=yes; }; \
	check $(BIN)/ruff check; \
	check $(BIN)/flake8 $(SOURCES) setup.py; \
	check $(BIN)/pydocstyle --property-decorators=none $(SOURCES) setup.py; \
	check $(BIN)/mypy; \
	check $(BIN)/python -c "$(CHECK_MANIFEST)"; \
	test -z "$$failed"

venv: $(STAMP)  ## build or refresh .venv/ only

clean:  ## remove what the other targets and colcon made, except .venv/
	rm -rf out build install log dist *.egg-info
	rm -rf .pytest_cache .hypothesis .mypy_cache .ruff_cache
	find . -path ./$(VENV) -prune -o -name __pycache__ -type d -exec rm -rf {} +

distclean: clean  ## remove .venv/ too
	rm -rf $(VENV)

# ---- .venv: wheels and tools pinned, cam_motion itself linked to this tree -----------------------
# bin/ and the module come from an editable install, share/ and lib/ are links into the tree, so
# that an edit needs no reinstallation. (`pip install .` makes the same layout with copies.)
LINKS := share/cam_motion/package.xml=package.xml share/cam_motion/config=config \
  share/cam_motion/launch=launch share/cam_motion/README.md=README.md \
  share/ament_index/resource_index/packages/cam_motion=resource/cam_motion \
  $(foreach s,$(notdir $(wildcard scripts/*)),lib/cam_motion/$(s)=scripts/$(s))

$(STAMP): requirements.txt requirements-dev.txt setup.py setup.cfg pyproject.toml package.xml
	$(eval BASE := $(find-python))
	$(if $(BASE),,$(error $(NO_WHEELS)))
	@echo 'Setting up $(VENV)/ with the ROS 2 Jazzy wheels; usually 10 to 90 s, log in $(LOG) ...'
	@mkdir -p $(dir $(LOG))
	@( set -x; export VIRTUAL_ENV="$(CURDIR)/$(VENV)"; \
	  pip="$(BIN)/python -m pip --disable-pip-version-check"; \
	  install() { $(BIN)/uv pip install --compile-bytecode "$$@" || $$pip install "$$@"; }; \
	  { test -x $(BIN)/python || $(BASE) -m venv $(VENV); } && \
	  touch $(VENV)/COLCON_IGNORE && \
	  { $$pip install uv || echo 'no uv: pip does it alone'; } && \
	  install -r requirements-dev.txt && \
	  install --no-deps --no-build-isolation -e . && \
	  for link in $(LINKS); do \
	    to="$(VENV)/$${link%=*}" && rm -rf "$$to" && mkdir -p "$${to%/*}" && \
	    ln -s "$(CURDIR)/$${link#*=}" "$$to" || exit; \
	  done && \
	  $(BIN)/python -m compileall -q cam_motion ) >$(LOG) 2>&1 \
	  || { tail -n 25 $(LOG); echo 'Setting up $(VENV)/ failed; see $(LOG).'; exit 1; }
	@touch $@
