# photonbench. The two commands: `make demo` and `make check`. All of them: `make help`.

CC ?= cc
CFLAGS ?= -O2 -g
BUILD ?= build
PREFIX ?= /usr/local
DESTDIR ?=
OPENMP ?= -fopenmp
VERSION := $(shell sed -n 's/.*PM_VERSION "\(.*\)".*/\1/p' src/cli/version.h)
SO_MAJOR = 0

WARNINGS = -Wall -Wextra -Wpedantic -Wshadow -Wconversion
# -ffp-contract=off: every SIMD width, compiler and optimisation rounds alike.
PM_CFLAGS = -std=c11 -D_GNU_SOURCE $(WARNINGS) -ffp-contract=off -fno-math-errno $(CFLAGS)

LIB_DIRS = src/base src/map src/search estimators src/lookup
PROGRAM_DIRS = src/stats src/scene src/transport src/transport/policies src/image src/metrics cases cases/scenes \
    src/methods src/methods/progressive src/accuracy src/converge src/storage src/stress src/report \
    bench bench/workloads src/cli
LIB_SOURCES := $(wildcard $(addsuffix /*.c,$(LIB_DIRS)))
PROGRAM_SOURCES := $(filter-out src/cli/main.c,$(wildcard $(addsuffix /*.c,$(PROGRAM_DIRS))))
# Peers: libraries that `search` compares with, each compiled in where its headers are. `make PEERS=` leaves all out.
CXX ?= c++
HASH := \#
has_header = $(shell printf '$(HASH)if !__has_include(<$(1)>)\n$(HASH)error\n$(HASH)endif\n' | \
    $(CXX) -std=c++17 -E -x c++ - >/dev/null 2>&1 && echo yes)
peer_if = $(if $(call has_header,$(2)),$(1))
PEERS ?= $(call peer_if,nanoflann,nanoflann.hpp) $(call peer_if,flann,flann/flann.hpp) $(call peer_if,ann,ANN/ANN.h) \
    $(call peer_if,cgal,CGAL/Kd_tree.h) $(call peer_if,embree,embree3/rtcore.h)
PEERS := $(strip $(PEERS))
PEER_TBB := $(if $(filter cgal,$(PEERS)),$(call has_header,tbb/parallel_for.h))
PEER_LIBS := $(if $(filter flann,$(PEERS)),-lflann_cpp -llz4) $(if $(filter ann,$(PEERS)),-lann) \
    $(if $(PEER_TBB),-ltbb) $(if $(PEERS),-lstdc++)
PEER_DEFINES := $(foreach p,$(PEERS),-DPM_PEER_$(shell echo $(p) | tr a-z A-Z))
# Their best: optimised whatever CFLAGS say, without assertions; warnings in their headers are theirs.
PEER_CXXFLAGS = -std=c++17 -O2 -DNDEBUG -fvisibility=hidden $(if $(PEER_TBB),-DCGAL_LINKED_WITH_TBB)
PEER_OBJECTS := $(BUILD)/obj/bench/peers/list.o $(PEERS:%=$(BUILD)/obj/bench/peers/%.o)

LIB_OBJECTS := $(LIB_SOURCES:%.c=$(BUILD)/obj/%.o)
PROGRAM_OBJECTS := $(PROGRAM_SOURCES:%.c=$(BUILD)/obj/%.o) $(PEER_OBJECTS)
MAIN_OBJECT := $(BUILD)/obj/src/cli/main.o
TESTS := $(patsubst tests/%.c,$(BUILD)/tests/%,$(wildcard tests/*/test_*.c))
FUZZERS := $(patsubst tests/fuzz/%.c,$(BUILD)/fuzz/%,$(wildcard tests/fuzz/fuzz_*.c))
FUZZ_SECONDS ?= 3600
SHARED = libphotonmap.so.$(VERSION)

INTO = "$(DESTDIR)$(PREFIX)"
# Kept in the build folder; what was compiled with others is compiled again.
FLAGS = $(strip $(CC) $(PM_CFLAGS) $(OPENMP) $(LDFLAGS))
# The kinds of tests that check and check-san run: all, unless named.
KINDS ?=
# The commands that install their dependencies build on all processors, unless make was told how many.
PARALLEL = $(if $(filter -j%,$(MAKEFLAGS)),,-j$(shell nproc))

# Headers that a target depends on. By a name that holds whichever way BUILD is spelt: build, ./build, or its full path.
DEPENDENCIES = -MMD -MP -MT '$$(BUILD)$(patsubst $(BUILD)%,%,$@)'

Q = $(if $(V),,@)
say = $(if $(V),,@printf '  %-7s %s\n' $(1) $(2))

##@ Build
all: lib program ## the program and both libraries (the default)
lib: $(BUILD)/libphotonmap.a $(BUILD)/libphotonmap.so $(BUILD)/photonmap.pc ## libphotonmap alone
program: $(BUILD)/photonbench
install: lib program ## program, libraries, header and photonmap.pc into PREFIX (/usr/local)
	$(call say,INSTALL,$(INTO))
	$(Q)install -d $(INTO)/bin $(INTO)/include $(INTO)/lib/pkgconfig
	$(Q)install -m 755 $(BUILD)/photonbench $(INTO)/bin/
	$(Q)install -m 644 src/photonmap.h $(INTO)/include/
	$(Q)install -m 644 $(BUILD)/libphotonmap.a $(INTO)/lib/
	$(Q)install -m 755 $(BUILD)/$(SHARED) $(INTO)/lib/
	$(Q)ln -sf $(SHARED) $(INTO)/lib/libphotonmap.so.$(SO_MAJOR)
	$(Q)ln -sf $(SHARED) $(INTO)/lib/libphotonmap.so
	$(Q)sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|' src/photonmap.pc.in > $(INTO)/lib/pkgconfig/photonmap.pc
uninstall: ## removes what install put there
	$(Q)rm -f $(INTO)/bin/photonbench $(INTO)/include/photonmap.h $(INTO)/lib/libphotonmap.a \
	    $(INTO)/lib/libphotonmap.so* $(INTO)/lib/pkgconfig/photonmap.pc
clean: ## removes the build folder
	$(Q)rm -rf $(BUILD)

##@ Run
demo: deps-build ## the quick accuracy suite: table on screen, rows in build/demo/accuracy.json
	$(Q)$(MAKE) --no-print-directory $(PARALLEL) run-demo
run-demo: program
	$(Q)mkdir -p $(BUILD)/demo
	$(Q)$(BUILD)/photonbench accuracy --profile quick --json $(BUILD)/demo/accuracy.json

bench: deps-bench ## searches against peer libraries, then tracing and rendering: tables, rows in build/bench/*.json
	$(Q)$(MAKE) --no-print-directory $(PARALLEL) run-bench
run-bench: program
	$(Q)mkdir -p $(BUILD)/bench
	$(Q)$(BUILD)/photonbench search --case box,square,caustic,volume --k 8,50,500 --radius auto:50 --threads 1 \
	    --search all --seconds 400 --json $(BUILD)/bench/search.json -o $(BUILD)/bench/search.txt
	$(Q)cat $(BUILD)/bench/search.txt
	$(Q)$(BUILD)/photonbench speed --json $(BUILD)/bench/speed.json -o $(BUILD)/bench/speed.txt
	$(Q)cat $(BUILD)/bench/speed.txt

report: deps-report ## measures for up to two hours, goes on where it was stopped: build/report/index.html
	$(Q)$(MAKE) --no-print-directory $(PARALLEL) run-report
run-report: program
	$(Q)reports/make.sh $(BUILD)

##@ Check
check: deps ## every test
	$(Q)$(MAKE) --no-print-directory $(PARALLEL) run-tests
check-san: deps ## every test under the address and undefined-behaviour sanitizers
	$(Q)CK_TIMEOUT_MULTIPLIER=10 $(MAKE) --no-print-directory $(PARALLEL) BUILD=$(BUILD)/san run-tests \
	    CFLAGS="-O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all"
check-tsan: deps ## what runs on several threads, under the thread sanitizer
	$(Q)$(MAKE) --no-print-directory $(PARALLEL) BUILD=$(BUILD)/tsan OPENMP= \
	    CFLAGS="-O1 -g -fsanitize=thread" tests program
	$(Q)tests/threads.sh $(BUILD)/tsan
coverage: deps ## lines and branches of src/ and estimators/ that the tests of KINDS reach (all but stat), with gcov
	$(Q)$(MAKE) --no-print-directory $(PARALLEL) BUILD=$(BUILD)/coverage CFLAGS="-O0 -g --coverage" tests lib program
	$(Q)tests/coverage.sh $(BUILD)/coverage $(KINDS)
fuzz: ## each fuzzer for FUZZ_SECONDS (3600), with clang's libFuzzer and sanitizers
	$(Q)$(MAKE) --no-print-directory $(PARALLEL) CC=clang BUILD=$(BUILD)/fuzzing fuzzers \
	    CFLAGS="-O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all"
	$(Q)tests/fuzz/run_fuzz.sh $(BUILD)/fuzzing $(FUZZ_SECONDS)
fuzzers: $(FUZZERS)
check-report: ## the report's page in headless Chromium (as root installs what that takes)
	$(Q)tests/page/run.sh $(BUILD)
check-full: check check-san check-tsan coverage ## all of that, faults at every place, valgrind, every SIMD width
	$(Q)PM_FULL=1 tests/run.sh $(BUILD) stat faults
	$(Q)tests/widths.sh $(BUILD)
	$(Q)CC="$(CC)" .ci/deps.sh install full
	$(Q)tests/valgrind.sh $(BUILD)
tests: $(TESTS) ## builds the tests
run-tests: tests lib program
	$(Q)tests/structure.sh
	$(Q)CC="$(CC)" tests/install.sh $(BUILD)
	$(Q)tests/run.sh $(BUILD) $(KINDS)

##@ Dependencies
deps: ## installs what the build and the tests need (as root; else names the apt line)
	$(Q)CC="$(CC)" .ci/deps.sh install build check
deps-build: ## the same for the build alone
	$(Q)CC="$(CC)" .ci/deps.sh install build
deps-bench: ## the same for the benchmarks: the peer libraries
	$(Q)CC="$(CC)" .ci/deps.sh install build bench
deps-report: ## the same for the report: the peer libraries and gnuplot
	$(Q)CC="$(CC)" .ci/deps.sh install build bench report
help: ## this list
	@awk 'BEGIN {FS = ":.*##"} /^##@/ {printf "\n%s\n", substr($$0, 5)} \
	    /^[a-z-]+:.*##/ {printf "  make %-12s %s\n", $$1, $$2}' Makefile
	@printf '\nVariables: V=1 shows commands; CC, CFLAGS, BUILD, PREFIX, DESTDIR as usual.\n'
	@printf 'REPORT_PROFILE=quick makes a small report in a few minutes: build/report-quick/index.html.\n'

# Rules

ifneq ($(file <$(BUILD)/.flags),$(FLAGS))
.PHONY: $(BUILD)/.flags
endif
$(BUILD)/.flags: .ci/deps.sh
	$(Q)CC="$(CC)" .ci/deps.sh name build
	$(Q)mkdir -p $(@D) && printf '%s\n' '$(subst ','\'',$(FLAGS))' >$@
$(BUILD)/.check-deps: .ci/deps.sh
	$(Q)CC="$(CC)" .ci/deps.sh name build check
	$(Q)mkdir -p $(@D) && touch $@

# The library is plain C11: no OpenMP, and position independent for the shared one.
$(LIB_OBJECTS): PM_EXTRA = -fPIC -fvisibility=hidden
ifneq ($(filter x86_64%,$(shell $(CC) -dumpmachine 2>/dev/null)),)
$(BUILD)/obj/src/search/wide_v2.o $(BUILD)/obj/src/search/grid_v2.o: PM_EXTRA += -O3 -msse4.2 -mpopcnt
$(BUILD)/obj/src/search/wide_avx2.o $(BUILD)/obj/src/search/grid_avx2.o: PM_EXTRA += -O3 -mavx2 -mbmi -mbmi2 -mpopcnt
$(BUILD)/obj/src/search/wide_avx512.o $(BUILD)/obj/src/search/grid_avx512.o: PM_EXTRA += -O3 \
    -mavx512f -mavx512bw -mavx512dq -mavx512vl -mbmi -mbmi2 -mpopcnt
endif
$(PROGRAM_OBJECTS) $(MAIN_OBJECT): PM_EXTRA = $(OPENMP)
# Looked into once for every photon that is stored or is not.
$(patsubst %,$(BUILD)/obj/src/transport/%.o,cells plots density_decide keep_density): PM_EXTRA += -O3
BATCHES = $(foreach loops,scene/batch transport/lanes,\
    $(patsubst %,$(BUILD)/obj/src/$(loops)_%.o,plain avx2 avx512))
# Loops are to become SIMD (where clang cannot, it need not say so); nobody looks at floating-point exceptions.
$(BATCHES): PM_EXTRA += -O3 -fopenmp-simd -fno-trapping-math -Wno-pass-failed
ifneq ($(filter x86_64%,$(shell $(CC) -dumpmachine 2>/dev/null)),)
$(filter %_avx2.o,$(BATCHES)): PM_EXTRA += -mavx2
$(filter %_avx512.o,$(BATCHES)): PM_EXTRA += -mavx512f -mavx512dq -mavx512vl -mavx512bw -mprefer-vector-width=512
endif
BUILD_FLAGS = $(subst ",,$(strip $(CFLAGS) -ffp-contract=off $(OPENMP)))
$(BUILD)/obj/src/cli/machine.o: PM_EXTRA += -DPM_BUILD_FLAGS='"$(BUILD_FLAGS)"'

$(BUILD)/obj/%.o: %.c $(BUILD)/.flags
	$(call say,CC,$<)
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(PM_CFLAGS) $(PM_EXTRA) $(DEPENDENCIES) -c $< -o $@

# The stored references are within this object.
$(BUILD)/obj/src/image/reference.o: $(wildcard cases/scenes/references/*.exr)

# So are the report's page, its list of errata and the scripts of its figures in these.
$(BUILD)/obj/src/report/page.o: reports/page/dist/page.html reports/errata.json
$(BUILD)/obj/src/report/figures.o: $(wildcard reports/figures/*.gp)

$(BUILD)/obj/bench/peers/list.o: PM_EXTRA += $(PEER_DEFINES)
$(BUILD)/obj/bench/peers/list.o: $(BUILD)/obj/bench/peers/.found

# Changes when the peers do, so that they come in as they are installed.
$(BUILD)/obj/bench/peers/.found: .FORCE
	$(Q)mkdir -p $(@D)
	$(Q)echo '$(PEERS)' | cmp -s - $@ || echo '$(PEERS)' > $@

$(BUILD)/obj/bench/peers/%.o: bench/peers/%.cc $(BUILD)/obj/bench/peers/.found
	$(call say,CXX,$<)
	$(Q)mkdir -p $(@D)
	$(Q)$(CXX) $(PEER_CXXFLAGS) $(DEPENDENCIES) -c $< -o $@

$(BUILD)/libphotonmap.a: $(LIB_OBJECTS)
	$(call say,AR,$@)
	$(Q)rm -f $@ && $(AR) rcs $@ $^

$(BUILD)/libphotonmap.so: $(LIB_OBJECTS) src/cli/version.h
	$(call say,LD,$@)
	$(Q)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,libphotonmap.so.$(SO_MAJOR) $(LIB_OBJECTS) -lm -o $(BUILD)/$(SHARED)
	$(Q)ln -sf $(SHARED) $(BUILD)/libphotonmap.so.$(SO_MAJOR) && ln -sf $(SHARED) $@

$(BUILD)/photonmap.pc: src/photonmap.pc.in src/cli/version.h
	$(Q)mkdir -p $(@D)
	$(Q)sed 's|@PREFIX@|$(PREFIX)|; s|@VERSION@|$(VERSION)|' $< > $@

$(BUILD)/program.a: $(PROGRAM_OBJECTS)
	$(call say,AR,$@)
	$(Q)rm -f $@ && $(AR) rcs $@ $^

$(BUILD)/photonbench: $(MAIN_OBJECT) $(BUILD)/program.a $(BUILD)/libphotonmap.a
	$(call say,LD,$@)
	$(Q)$(CC) $(CFLAGS) $(OPENMP) $(LDFLAGS) $^ $(PEER_LIBS) -lembree3 -lOpenEXRCore -lpng -ljansson -lm -o $@

# Tests of faults stand between the program and what it asks of the system (tests/faults/allocation.h).
WRAPPED = malloc calloc realloc aligned_alloc free strdup strndup asprintf fopen fdopen open_memstream rtcNewDevice
$(BUILD)/tests/faults/%_memory: PM_WRAP = $(WRAPPED:%=-Wl,--wrap=%)

# Tests see the program's parts as well as the library's, so they link the static archives.
$(BUILD)/tests/%: tests/%.c $(BUILD)/program.a $(BUILD)/libphotonmap.a $(BUILD)/.flags | $(BUILD)/.check-deps
	$(call say,TEST,$@)
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(PM_CFLAGS) $(OPENMP) -DPM_BUILD='"$(abspath $(BUILD))"' $(DEPENDENCIES) -MF $@.d $(LDFLAGS) $(PM_WRAP) $< \
	    $(BUILD)/program.a $(BUILD)/libphotonmap.a $(PEER_LIBS) -lembree3 -lOpenEXRCore -lpng \
	    `pkg-config --libs check gsl mpfr jansson` -lm -o $@

$(BUILD)/fuzz/%: tests/fuzz/%.c $(BUILD)/program.a $(BUILD)/libphotonmap.a $(BUILD)/.flags
	$(call say,FUZZ,$@)
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(PM_CFLAGS) $(OPENMP) $(DEPENDENCIES) -MF $@.d $(LDFLAGS) -fsanitize=fuzzer $< $(BUILD)/program.a \
	    $(BUILD)/libphotonmap.a $(PEER_LIBS) -lembree3 -lOpenEXRCore -lpng -ljansson -lm -o $@

-include $(LIB_OBJECTS:.o=.d) $(PROGRAM_OBJECTS:.o=.d) $(MAIN_OBJECT:.o=.d) $(TESTS:=.d) $(FUZZERS:=.d)
.PHONY: all lib program install uninstall clean demo run-demo bench run-bench report run-report \
    check check-san check-tsan check-report check-full coverage fuzz fuzzers tests run-tests \
    deps deps-build deps-bench deps-report help .FORCE
.DELETE_ON_ERROR:
