# Everything people do here. `./bootstrap WORD` installs what a machine lacks and then calls `make WORD`.
# fpm builds; this file only holds the flags and the order of the steps.

export PATH := $(CURDIR)/.venv/bin:$(PATH)
export OPENBLAS_NUM_THREADS := 1
# The HDF5 of the serial library, also where an MPI library has put itself in front.
export PKG_CONFIG_PATH := $(CURDIR)/.pc:$(PKG_CONFIG_PATH)

PYTHON := python3
NATIVE ?= 0
WERROR ?= 0
COMMON := -std=f2018 -fPIC -g -fbacktrace -fmax-errors=5 -Wall -Wextra $(if $(filter 1,$(WERROR)),-Werror)
RELEASE := $(COMMON) -O3 -funroll-loops -Wno-maybe-uninitialized $(if $(filter 1,$(NATIVE)),-march=native)
DEBUG := $(COMMON) -O1 -fcheck=all,no-array-temps -finit-real=snan -finit-integer=-99999999 -ffpe-trap=invalid,zero,overflow

.DEFAULT_GOAL := help
.PHONY: help build debug unit unit-debug clean prepare generate

help: ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "make %-12s %s\n", $$1, $$2}' Makefile

build: prepare ## the program, build/bin/asperity (NATIVE=1: for this processor only)
	fpm install --flag "$(RELEASE)" --prefix build

debug: prepare ## the checked program, build/bin/asperity-debug (bounds, NaN initialisation, floating-point traps)
	fpm install --flag "$(DEBUG)" --prefix build/debug
	@mkdir -p build/bin && cp build/debug/bin/asperity build/bin/asperity-debug

unit: prepare generate ## the unit tests (ARGS="-f NAME -v" chooses and lists)
	fpm test --flag "$(RELEASE)" -- $(ARGS)

unit-debug: prepare generate ## the unit tests, checked build
	fpm test --flag "$(DEBUG)" -- $(ARGS)

clean: ## remove everything that make has made
	rm -rf build results test/generated docs/api .pc .pytest_cache

generate:
	@$(PYTHON) tools/pf2f90.py test/generated $(sort $(wildcard test/unit/*/test_*.pf))

prepare:
	@sh tools/prepare.sh
