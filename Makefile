# Everything people do here. `./bootstrap WORD` installs what a machine lacks and then calls `make WORD`.
# fpm builds; this file only holds the flags and the order of the steps.

export PATH := $(CURDIR)/.venv/bin:$(PATH)
export OPENBLAS_NUM_THREADS := 1
export FPM_FC := tools/gfortran
# The HDF5 of the serial library, also where an MPI library has put itself in front.
export PKG_CONFIG_PATH := $(CURDIR)/.pc:$(PKG_CONFIG_PATH)

# Libraries inside the program where that is possible (tools/static_libraries.sh).
export FPM_LDFLAGS := -Lbuild/static -static-libgfortran -static-libgcc -Wl,--as-needed

PYTHON := python3
NATIVE ?= 0
OPT ?= -O3
WERROR ?= 0
# OpenMP shares areas between threads (--threads); with it all local arrays are on the stack: none becomes static, kept between calls.
# The checked build has one thread and local arrays up to 1 MB on the stack: with OpenMP every allocatable result, assigned to an
# allocatable, counts as uninitialized.
# Of no use: allocatable results are taken for uninitialized, a clock in `a .or. clock() > b` need not be read, and an index
# that an `if` guards counts as out of bounds (the checked build looks at run time).
COMMON := -std=f2018 -fimplicit-none -g -fbacktrace -fmax-errors=20 -Wall -Wextra -Wno-maybe-uninitialized -Wno-function-elimination -Wno-do-subscript $(if $(filter 1,$(WERROR)),-Werror)
# With OpenMP some of these results even count as certainly uninitialized; the checked build looks for what is.
RELEASE := $(COMMON) -Wno-uninitialized -fopenmp $(OPT) -funroll-loops -fno-semantic-interposition $(if $(filter 1,$(NATIVE)),-march=native)
DEBUG := $(COMMON) -fmax-stack-var-size=1048576 -O1 -fcheck=all,no-array-temps -finit-real=snan -finit-integer=-99999999 -ffpe-trap=invalid,zero,overflow
# Without OpenMP, as the checked build. Not `null`: gfortran loads the address of an optional argument that is absent; a null pointer
# that is used for more than that ends in a report of the other sanitizer.
SANITIZE := $(COMMON) -fmax-stack-var-size=1048576 -O1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize=null

DEMO_CASES := input/case3_demo.nml input/case1.nml input/dry_profile.nml input/dry_area.nml
DEMO := results/demo

.DEFAULT_GOAL := help
.PHONY: help build debug test test-debug unit unit-debug sanitize golden fuzz lint demo figures bench chart accuracy accuracy-time stability docs site notebooks wheel clean prepare generate

help: ## this list
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / {printf "make %-12s %s\n", $$1, $$2}' Makefile

build: prepare ## the programs build/bin/asperity, asperity-heights and asperity-duty (NATIVE=1: for this processor only)
	@tools/fpm_build.sh --flag "$(RELEASE)"
	@fpm install --flag "$(RELEASE)" --prefix build > build/install.log

debug: prepare ## the checked program, build/bin/asperity-debug (bounds, NaN initialisation, floating-point traps)
	@tools/fpm_build.sh --flag "$(DEBUG)"
	@fpm install --flag "$(DEBUG)" --prefix build/debug > build/install.log
	@mkdir -p build/bin && cp build/debug/bin/asperity build/bin/asperity-debug

sanitize: export FPM_LDFLAGS :=
sanitize: prepare generate ## build/bin/asperity-sanitize (addresses, undefined behaviour, leaks); unit tests and 200 random cases with it
	@tools/fpm_build.sh --tests --flag "$(SANITIZE)"
	@fpm install --flag "$(SANITIZE)" --prefix build/sanitize > build/install.log
	@mkdir -p build/bin && cp build/sanitize/bin/asperity build/bin/asperity-sanitize
	tools/sanitized.sh fpm test --flag "$(SANITIZE)" -- $(ARGS)
	ASPERITY=build/bin/asperity-sanitize tools/sanitized.sh $(PYTHON) test/fuzz/run.py valid_cases --cases 200

test: build generate ## all tests: unit tests, then end-to-end tests of build/bin/asperity
	@tools/fpm_build.sh --tests --flag "$(RELEASE)"
	@$(PYTHON) tools/run_tests.py build/bin/asperity fpm test --flag "$(RELEASE)" -- -v

test-debug: debug generate ## the same with the checked build (ARGS=--paths: only end-to-end tests marked `path`)
	@tools/fpm_build.sh --tests --flag "$(DEBUG)"
	@$(PYTHON) tools/run_tests.py $(ARGS) build/bin/asperity-debug fpm test --flag "$(DEBUG)" -- -v

golden: build ## files and output of small cases against stored ones (ARGS=--store: store them; ARGS=--count: instructions)
	$(PYTHON) test/golden.py $(ARGS)

fuzz: build ## attacks with damaged, hostile and odd files; writes the table of docs/testing.md (ARGS="KIND --seed S": without it)
	$(PYTHON) test/fuzz/run.py $(or $(ARGS),--page)

unit: prepare generate ## the unit tests alone (ARGS="-f NAME -v" chooses and lists; PFUNIT_DIR=... uses real pFUnit)
ifdef PFUNIT_DIR
	$(MAKE) -f tools/pfunit.mk FLAGS="$(RELEASE)" ARGS="$(ARGS)"
else
	@tools/fpm_build.sh --tests --flag "$(RELEASE)"
	@fpm test --flag "$(RELEASE)" -- $(ARGS)
endif

unit-debug: prepare generate ## the unit tests alone, checked build
	@tools/fpm_build.sh --tests --flag "$(DEBUG)"
	@fpm test --flag "$(DEBUG)" -- $(ARGS)

lint: ## style of Fortran, Python and shell, types of the Python package, order of the layers, ignored errors, unhandled cases
	fortitude check --quiet --output-format concise
	$(PYTHON) tools/check_layers.py
	$(PYTHON) tools/use_graph.py --most 18
	$(PYTHON) tools/check_errors.py
	$(PYTHON) tools/check_cases.py
	$(PYTHON) tools/check_reads.py
	$(PYTHON) tools/check_public.py
	$(PYTHON) tools/check_size.py
	ruff check --quiet .
	ruff format --quiet --check .
	$(PYTHON) -m mypy --no-error-summary python/asperity
	shellcheck bootstrap .ci/run .ci/nightly tools/python-command tools/gfortran $(wildcard tools/*.sh python/packaging/*.sh batch/*.sh batch/*.sbatch)
	@echo "lint: no findings"

demo: build ## the main job: a ridge passing through an oil film, a rough profile and area; results and figures in results/demo/
	@mkdir -p $(DEMO)
	build/bin/asperity $(DEMO_CASES) --output $(DEMO)
	@$(MAKE) --no-print-directory figures

figures: ## the figures of the demo again, from its result files
	$(PYTHON) postproc/profile.py $(DEMO)/case1.h5 $(DEMO)/case3_demo.h5 --output $(DEMO)
	$(PYTHON) postproc/transient.py $(DEMO)/case3_demo.h5 --output $(DEMO)
	$(PYTHON) postproc/convergence.py $(DEMO)/case1.h5 $(DEMO)/case3_demo.h5 --output $(DEMO)
	$(PYTHON) postproc/dry.py $(DEMO)/dry_profile.h5 $(DEMO)/dry_area.h5 --output $(DEMO)
	@echo "figures in $(DEMO):" && ls $(DEMO)

.PHONY: formulas regime scenes chapter3 chapter4 chapter5 chapter6 chapter7 area bench-dry amplitude trends thesis dry
chapter5: build ## thesis, chapter 5: Cases 1 to 3, error tables, figures, statements (ARGS=--quick)
	$(PYTHON) bench/studies/chapter5.py $(ARGS)

chapter6: build ## thesis, chapter 6: every overtaking of ridges and dents, figures, statements (ARGS=--quick)
	$(PYTHON) bench/studies/chapter6.py $(ARGS)

amplitude: build ## amplitude reduction of a waviness, rolling and sliding, against published values (ARGS=--quick)
	$(PYTHON) bench/studies/amplitude.py $(ARGS)

trends: build ## dependence of film and waviness on each input, against (2.3) and the fit of Moes (ARGS=--quick)
	$(PYTHON) bench/studies/trends.py $(ARGS)

thesis: chapter5 chapter6 amplitude trends ## the lubricated half of the thesis: the four above, and their figures into docs/images/
	$(PYTHON) bench/studies/page_images.py chapter5 chapter6 amplitude

regime: build ## films over Moes' numbers, for the chart of postproc/regime.py, into postproc/data/ (ARGS=--quick)
	$(PYTHON) bench/studies/moes_films.py $(ARGS)

formulas: build ## bias of handbook film formulas against computed films (ARGS=--quick)
	$(PYTHON) bench/studies/film_formulas.py $(ARGS)

scenes: build ## the scenes of input/scenes/: verdicts against fine grids; the histories of input/duty/: error bars
	-$(PYTHON) bench/adequacy.py --kinds scene --output results/scenes $(ARGS)
	-$(PYTHON) bench/families.py histories --output results/scenes $(ARGS)

chapter3: build ## thesis, chapter 3: elastic against elastic-perfectly plastic, load, unload, reload (ARGS=--quick)
	$(PYTHON) bench/studies/chapter3.py $(ARGS)

chapter4: build ## thesis, chapter 4: which harmonics and how many nodes the contact area needs, statements (ARGS=--quick)
	$(PYTHON) bench/studies/chapter4.py $(ARGS)

area: build ## contact area of rough areas against the load, with its error (ARGS=--quick)
	$(PYTHON) bench/studies/area.py $(ARGS)

chapter7: build ## thesis, chapter 7 and Paper C: four dry profiles, 18 loads, 50 realisations of each, statements (ARGS=--quick)
	$(PYTHON) bench/studies/chapter7.py $(ARGS)

dry: chapter3 chapter4 chapter7 area ## the dry half of the thesis: chapters 3, 4, 7 and rough areas, and their figures into docs/images/
	$(PYTHON) bench/studies/page_images.py chapter3 chapter4 chapter7 area

bench: build ## speed and memory, in results/bench/ (ARGS=--quick: shorter)
	$(PYTHON) bench/run.py $(ARGS)

bench-dry: build ## dry areas against other programs (ARGS="--peers PYTHON": the python of an environment with tamaas, ContactMechanics)
	$(PYTHON) bench/dry_areas.py $(ARGS)

chart: build ## error against wall time of all methods, in results/chart/ (ARGS=--quick; PEERS=PYTHON: dry areas by other programs too)
	$(PYTHON) bench/chart.py $(ARGS)
	$(PYTHON) bench/chart.py --dry $(ARGS) $(if $(PEERS),--peers $(PEERS))

accuracy: build ## truth of the error bars, in results/accuracy/ (ARGS=--quick: shorter)
	$(PYTHON) bench/families.py $(ARGS)

accuracy-time: build ## the same for passages, cost of a target accuracy (ARGS=--quick: fewer)
	$(PYTHON) bench/targets.py $(ARGS)
	$(PYTHON) bench/families.py passages --output results/accuracy/passages $(ARGS)

stability: build ## maps of convergence of each method, in results/stability/ (ARGS=--quick: shorter)
	$(PYTHON) bench/stability.py $(ARGS)
	$(PYTHON) bench/stability.py --dry $(ARGS)

docs: prepare ## the pages of the programming interface, docs/api/index.html; a warning is an error
	@sh tools/build_docs.sh

site: ## the pages as a site with search, build/site/index.html; a broken link is an error
	@test -x build/site-tools/bin/mkdocs || { python3 -m venv build/site-tools && \
	   build/site-tools/bin/pip install -q --disable-pip-version-check -r tools/requirements-site.txt; }
	@NO_MKDOCS_2_WARNING=1 build/site-tools/bin/mkdocs build -q -f tools/site.yml && echo build/site/index.html

notebooks: build ## executes the notebooks again
	PYTHONPATH=$(CURDIR)/python jupyter execute --inplace python/notebooks/*.ipynb

wheel: build ## a Python package with the program, for any Linux on this kind of processor, in dist/
	@rm -rf build/wheel dist
	$(PYTHON) -m pip wheel -q --disable-pip-version-check --no-build-isolation --no-deps --wheel-dir build/wheel .
	auditwheel repair --wheel-dir dist build/wheel/*.whl
	@ls -s --block-size=1M dist/*.whl

clean: ## removes everything that make has written
	rm -rf build dist results test/generated docs/api .pc

generate:
	@$(PYTHON) tools/pf2f90.py test/generated $(sort $(wildcard test/unit/*/test_*.pf test/verification/test_*.pf test/support/*.pf))

prepare:
	@sh tools/prepare.sh
	@install -D tools/python-command build/bin/asperity-heights
	@install -D tools/python-command build/bin/asperity-duty
