# make run    a simulated robot that asks to be taught, and the page to teach it from; ARGS=--auto teaches by itself
# make demo   a scripted teacher teaches it in simulated time, then it is examined: a minute
# make test   lint, types, and the tests that need nothing but Python
# make trust  those tests twenty times, ten of them next to busy processors: two hours; RUNS=4 BUSY=2 does fewer
# make size   token lines of each room, next to its budget and to the last commit
# make kills  the robot program is killed over and over while it is taught; SHARD=2/8 does an eighth of 10 000
# make stories  hours of many faults at once, each story told by a seed: an hour; ARGS='--hours 8 --stories 50000' a night
# make equal-lessons  1000 whole lessons in the batch and on the CAN bus; SHARD=2/8 gives an eighth of them
# make studies  the searches of config/searches again, from which settings come: hours
# make wheelhouse  all packages of a robot as wheels, for x86-64 and aarch64, to install without a network: a minute
# make site   the documentation as a site in site/, whose index.html opens without a network: 10 seconds
# make bench  what the runtime takes on this machine, next to references of the same run: 7 minutes; ARGS=--quick does a tenth
# make hil    the tests on the kernel's own CAN, in a machine that has it; HIL=--install installs Debian packages for it
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
INSTALLED := $(VENV)/installed
TESTED := $(VENV)/tested
INSTALL = $(BIN)/pip install --disable-pip-version-check --progress-bar off --constraint constraints.txt --editable
COMPILED := $(VENV)/compiled

# All workers and the programs they start would each compile all of it anew on a machine that keeps no bytecode.
PYTEST := PYTHONDONTWRITEBYTECODE= $(BIN)/pytest

.PHONY: run demo test trust test-deep guard mutants kills stories equal-lessons studies wheelhouse hil bench site lint types size clean

run: $(INSTALLED)
	$(BIN)/kurt2rt run --phone $(ARGS)

demo: $(INSTALLED)
	$(BIN)/kurt2rt demo

# Types take one processor; the other one compiles the tests meanwhile, once for all that run them. More workers than
# processors: stories wait for programs, browsers and real time; with four hands in browsers lose their robots.
test: $(TESTED)
	$(MAKE) --no-print-directory --jobs 3 --output-sync=target lint types size $(COMPILED)
	$(PYTEST) -n 3 -q --dist loadfile --no-loadscope-reorder

# A test that fails only on a busy machine is a fault of the test, or worse. Twice the processors of a small machine are
# busy in the last runs.
RUNS ?= 20
BUSY ?= 10
trust: $(TESTED) $(COMPILED)
	@failed=0; trap 'kill $$loops 2> /dev/null' EXIT; \
	for run in $$(seq $(RUNS)); do \
		if [ $$run -gt $$(($(RUNS) - $(BUSY))) ] && [ -z "$$loops" ]; then \
			for loop in 1 2 3 4; do $(BIN)/python -S -c 'while True: pass' & loops="$$loops $$!"; done; \
		fi; \
		echo "run $$run of $(RUNS)"; \
		$(PYTEST) -n 3 -q --dist loadfile --no-loadscope-reorder $(ARGS) || failed=$$((failed + 1)); \
	done; echo "$$failed runs failed"; [ $$failed -eq 0 ]

# A test that waits for a processor has not failed: six times what the quick ones have.
test-deep: $(TESTED) guard
	EXAMPLES=thorough $(PYTEST) -n 2 -q -m 'deep or hypothesis' --timeout 1800

# Every line and branch of the guard and of what it stands on, by the tests of hal alone.
guard: $(TESTED)
	EXAMPLES=thorough $(BIN)/coverage run -m pytest -q tests/hal -k 'not thousand_ticks'
	$(BIN)/coverage report

# Every small change to them has to make a test fail; minutes.
mutants: $(TESTED)
	$(BIN)/pip install --quiet --disable-pip-version-check --constraint constraints.txt mutmut
	EXAMPLES=thorough $(BIN)/python -m tests.hal.mutants

# The robot program is killed 10 000 times while it is taught: an hour of one processor; SHARD=2/8 is the second of eight.
SHARD ?= 1/1
KILLS ?= 10000
kills: $(TESTED)
	$(BIN)/python -m tests.crash.kills --kills $(KILLS) --shard $(SHARD)

# What breaks is shrunk, and stands in var/stories; python -m tests.stories FILE drives it again.
stories: $(TESTED)
	$(BIN)/python -m tests.stories $(ARGS)

# Two processors take three quarters of an hour.
LESSONS ?= 1000
equal-lessons: $(TESTED)
	$(BIN)/python -m tests.simbridge.batch.equal_lessons --lessons $(LESSONS) --shard $(SHARD)

# Each goes on where it was, and leaves its report in results/search.
SEARCHES ?= $(basename $(notdir $(wildcard config/searches/*.yaml)))
studies: $(TESTED)
	for name in $(SEARCHES); do $(BIN)/kurt2rt study search $$name || exit 1; done

# With a small environment of its own, because a robot needs no tests. Wheels for glibc 2.34 and newer, Debian 12.
ARCHITECTURES ?= x86_64 aarch64
EXTRAS ?= page,recording
ROBOT_PYTHON ?= 3.11
ABIS := cp$(subst .,,$(ROBOT_PYTHON)) abi3 none
wheelhouse:
	rm -rf wheelhouse build
	$(PYTHON) -m venv wheelhouse/venv
	for machine in $(ARCHITECTURES); do \
		wheelhouse/venv/bin/pip wheel --quiet --no-deps --wheel-dir wheelhouse/$$machine . \
		&& wheelhouse/venv/bin/pip download --quiet --dest wheelhouse/$$machine --constraint constraints.txt \
			--only-binary :all: --python-version $(ROBOT_PYTHON) --implementation cp $(ABIS:%=--abi %) \
			$(foreach glibc,2_17 2_28 2_34,--platform manylinux_$(glibc)_$$machine) --platform manylinux2014_$$machine \
			'.[$(EXTRAS)]' \
		&& (cd wheelhouse/$$machine && sha256sum *.whl | sed -E \
			's/^([0-9a-f]+)  ([^-]+)-([^-]+)-.*/\2==\3 --hash=sha256:\1/' > requirements.txt) || exit 1; \
		echo "wheelhouse/$$machine: $$(wc -l < wheelhouse/$$machine/requirements.txt) wheels"; \
	done
	rm -rf wheelhouse/venv build

# First that both machines can be had (the small kernel is built once, 3 minutes), then real time, then simulated time.
hil: $(TESTED)
	$(BIN)/python -m tests.hil.machine $(HIL) --check
	$(BIN)/python -m tests.hil.machine $(HIL) --simulated-time --check
	$(BIN)/python -m tests.hil.machine --limit 1800 $(BIN)/python -m pytest -q -m hil tests/hil
	$(BIN)/pytest -n 2 -q -m boots tests/hil

bench: $(TESTED)
	$(BIN)/python -m tests.bench $(ARGS)

# A link that leads nowhere is a failure.
site: $(TESTED)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict

lint: $(TESTED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/python -m tests.lint
	$(BIN)/hadolint Containerfile

types: $(TESTED)
	$(BIN)/mypy

# A room above its budget in pyproject.toml is a failure.
size: $(TESTED)
	$(BIN)/python -m tests.size

# What cannot be collected is told by the tests themselves.
$(COMPILED): $(TESTED) $(shell find tests -name '*.py')
	-@$(PYTEST) --collect-only -qqq > /dev/null 2>&1
	@$(BIN)/python -m tests.compile_batch
	@touch $@

# One environment for all: what is tested is what runs. A user needs a quarter of the packages of the tests.
$(INSTALLED): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "kurt2rt needs Python 3.11 or newer; give one with: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' \
		|| { echo "Python's venv is missing; on Debian: apt-get install python3-venv"; exit 1; }
	@echo "Installing kurt2rt and its packages into $(VENV), once: a minute or two, 0.4 GB of disk ..."
	$(PYTHON) -m venv $(VENV)
	$(INSTALL) '.[page,recording,simulation]'
	touch $@

$(TESTED): $(INSTALLED)
	@echo "Installing the packages of the tests into $(VENV), once: one to five minutes, 1 GB of disk ..."
	$(INSTALL) '.[test]'
	touch $@

clean:
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis .coverage mutants build wheelhouse *.egg-info
