# Two commands matter: `make render` draws the room, `make test` proves that it works. Both install what is missing.

PREFIX ?= /usr/local
CARGO ?= cargo
SCENE ?= scenes/room.json
IMAGES ?= out/$(basename $(notdir $(SCENE))).png out/$(basename $(notdir $(SCENE))).exr
ETENDUE = $(CARGO) run --quiet --release --locked --example etendue --

.PHONY: all setup render test bench install uninstall meshes clean
all: render

# Installs Embree, libclang and a C compiler where they are missing, with a line that says why.
setup:
	@scripts/setup.sh

# Renders SCENE (the report's room) to IMAGES; ARGS are further options, such as ARGS="--spp 64".
render: setup
	@mkdir -p out
	$(ETENDUE) render $(SCENE) --output $(IMAGES) $(ARGS)

# Everything that must hold: formatting, lints, tests, documentation, formats.
test: setup
	@scripts/test.sh

# Ray rates against Embree's own.
bench: setup meshes
	$(CARGO) bench --locked --bench rays --bench spheres

# Generated meshes that are too large to store.
meshes: out/million.obj
out/million.obj: | setup
	@mkdir -p out
	$(CARGO) run --quiet --release --locked --example million_triangles -- $@

install: setup
	$(CARGO) install --locked --path . --example etendue --root $(PREFIX) --force

uninstall:
	$(CARGO) uninstall --root $(PREFIX) etendue

clean:
	$(CARGO) clean
	rm -rf out
