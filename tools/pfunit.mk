# The unit tests with the real pFUnit: `make unit PFUNIT_DIR=/where/it/is/installed`.
# Called by the Makefile with FLAGS and ARGS; the library of the program is built by fpm.
PFUNIT_MK := $(firstword $(wildcard $(PFUNIT_DIR)/PFUNIT-*/include/PFUNIT.mk $(PFUNIT_DIR)/include/PFUNIT.mk))
ifeq ($(PFUNIT_MK),)
$(error no PFUNIT.mk below PFUNIT_DIR=$(PFUNIT_DIR))
endif
include $(PFUNIT_MK)
PFUNIT_PROCESSOR := $(firstword $(wildcard $(PFUNIT_BIN_DIR)/funitproc $(dir $(PFUNIT_MK))../bin/funitproc))

B := build/pfunit
TESTS := $(sort $(wildcard test/unit/*/test_*.pf test/verification/test_*.pf))
# Modules that tests share: plain Fortran, compiled first.
SHARED := $(sort $(wildcard test/support/*.pf))
SOURCES := $(addprefix $(B)/,$(addsuffix .F90,$(notdir $(basename $(SHARED) $(TESTS)))))
LIBRARIES := $(shell pkg-config --libs-only-L hdf5-serial) -lhdf5_fortran -lhdf5 $(shell pkg-config --libs fftw3f fftw3 openblas)
vpath %.pf $(sort $(dir $(TESTS)))

run: $(B)/unit
	$(B)/unit $(ARGS)

$(B)/unit: $(SOURCES) $(B)/suites.inc library
	cd $(B) && gfortran $(filter-out -Werror -std=%,$(FLAGS)) $(PFUNIT_EXTRA_FFLAGS) -ffree-line-length-none -Iinclude \
	   -I$(PFUNIT_INCLUDE_DIR) -D_TEST_SUITES='"suites.inc"' $(notdir $(SOURCES)) $(PFUNIT_INCLUDE_DIR)/driver.F90 \
	   -Llib -lasperity $(LIBRARIES) $(PFUNIT_LIBRARIES) -o unit

$(addprefix $(B)/,$(addsuffix .F90,$(notdir $(basename $(SHARED))))): $(B)/%.F90: test/support/%.pf | $(B)
	cp $< $@

$(B)/%.F90: %.pf | $(B)
	$(PFUNIT_PROCESSOR) $< $@

$(B)/suites.inc: $(TESTS) | $(B)
	printf 'ADD_TEST_SUITE(%s_suite)\n' $(notdir $(basename $(TESTS))) > $@

$(B):
	mkdir -p $@

.PHONY: run library
library:
	tools/fpm_build.sh --flag "$(FLAGS)"
	fpm install --flag "$(FLAGS)" --prefix $(B) > build/install.log
