# Two commands matter: `make render` draws the room, `make test` proves that it works. Both install what is missing.
# `make install` puts the library for C and C++, and the command line, into PREFIX.

PREFIX ?= /usr/local
# Where libraries go: PREFIX/lib if empty; under /usr, the folder of the processor (/usr/lib/x86_64-linux-gnu).
LIBDIR ?=
DESTDIR ?=
# Of Cargo.toml: `make test` tries what it has built for its tests.
ETENDUE_PROFILE ?= release
CARGO ?= cargo
SCENE ?= scenes/room.json
IMAGES ?= out/$(basename $(notdir $(SCENE))).png out/$(basename $(notdir $(SCENE))).exr
INSTALL = ETENDUE_PROFILE='$(ETENDUE_PROFILE)' CARGO='$(CARGO)' PREFIX='$(PREFIX)' LIBDIR='$(LIBDIR)' DESTDIR='$(DESTDIR)' scripts/install.sh
ETENDUE = $(CARGO) run --quiet --profile $(ETENDUE_PROFILE) --locked $(ETENDUE_FEATURES) --example etendue --

.PHONY: all setup render test accuracy mutations cuts attacks bench bench-rays peers-materials gallery pictures build install uninstall deb meshes clean
all: render

# Installs Embree, libclang and a C compiler where they are missing, with a line that says why.
setup:
	@scripts/setup.sh

# Renders SCENE (the report's room) to IMAGES; ARGS are further options, such as ARGS="--spp 64".
render: setup
	@mkdir -p out
	$(ETENDUE) render $(SCENE) --output $(IMAGES) $(ARGS)

# Everything that must hold: formatting, lints, tests, documentation, formats.
test:
	@scripts/setup.sh test
	@scripts/test.sh

# Every hard case with large numbers of rays and samples, and the arithmetic of other builds: prints the tables of
# docs/accuracy-tables.md (ETENDUE_WRITE=1 writes them there). About a quarter of an hour.
accuracy: setup
	ETENDUE_ACCURACY=full $(CARGO) test --locked --release --test accuracy
	scripts/arithmetic.sh

# Faults of one or two percent, one at a time: the hard cases must notice each. About half an hour.
mutations: setup
	scripts/mutations.pl

# Renders that are killed at random and gone on from, or merged from parts: their bytes are those of renders that are not cut. About
# a quarter of an hour.
cuts:
	@scripts/setup.sh test
	$(CARGO) build --quiet --release --locked --features mpi --example etendue --example etendue-mpi
	scripts/cuts.sh

# Attacks on the command line: kills, full disks, signals, limits of memory, odd and damaged files. About two minutes; docs/cli.md says what
# is known to fail. ARGS are its options, such as ARGS="--only kills,damaged".
attacks:
	$(CARGO) build --quiet --release --locked --example etendue
	python3 scripts/attacks.py $${CARGO_TARGET_DIR:-target}/release/examples/etendue scenes $(ARGS)

# Time and error of six scenes, with a report to open in a browser: out/bench/report.html. About ten minutes the first time,
# when references are rendered. SUITE is another suite; ARGS are further options, such as ARGS="--runs 1".
SUITE ?= benches/suites/default.json
bench: setup meshes
	$(ETENDUE) bench --suite $(SUITE) --output out/bench $(ARGS)

# Ray rates against Embree's own, and what robustness costs.
bench-rays: setup meshes
	$(CARGO) bench --locked --bench rays --bench spheres --bench editing --bench robust --bench photons --bench lights --bench growth --bench errors
	$(CARGO) bench --locked --features capi --bench hosts

# Pictures of every material beside Mitsuba 3's of the same meaning: fails where one is not the same but for noise. About a
# quarter of an hour. PEER is a Python with Mitsuba and numpy (peers/README.md).
PEER ?= peer/bin/python
peers-materials: setup
	$(CARGO) build --quiet --release --locked --example etendue
	$(PEER) peers/mitsuba/compare_materials.py $(ARGS)

# The pictures of docs/materials.md, one for each kind of material, and of docs/scenes.md. About ten minutes.
gallery: setup
	$(CARGO) build --quiet --release --locked --example etendue
	scripts/gallery.pl $${CARGO_TARGET_DIR:-target}/release/examples/etendue $(ARGS)

# Draws docs/gallery.md: every scene and every method, with time and error. About three minutes, during which nothing else should run.
pictures: setup meshes
	$(CARGO) build --quiet --release --locked --example etendue
	scripts/pictures.pl $(ARGS) $${CARGO_TARGET_DIR:-target}/release/examples/etendue

# Generated meshes that are too large to store.
meshes: out/million.obj
out/million.obj: | setup
	@mkdir -p out
	$(CARGO) run --quiet --release --locked --example million_triangles -- $@

# The libraries and the command line, optimised. Without cargo (as root, after a user's `make build`) what was built is
# taken as it is.
build:
	@if command -v $(CARGO) >/dev/null; then scripts/setup.sh && $(INSTALL) build; \
	else echo "no cargo here: taking what was built before"; fi

# Library, headers, pkg-config and CMake files, command line, manual and completions, in DESTDIR/PREFIX.
install: build
	@$(INSTALL) install

# The same as a Debian package, in target/debian.
deb:
	@scripts/deb.sh

# Removes what install put there.
uninstall:
	@$(INSTALL) uninstall

clean:
	$(CARGO) clean
	rm -rf out
