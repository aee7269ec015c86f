# Every target does its own set-up. One build profile serves all of them, so that Bevy is compiled once.
CARGO ?= cargo
ARGS ?=

.PHONY: help parrot eagle single fur chick inspector tour test gallery charts bench docs birds feathers tables setup

help:
	@echo "make parrot | eagle | single   show the example (off screen without a display); ARGS='--camera closeup' passes options"
	@echo "make fur | chick               fur on a bent cylinder; a young bird in its down"
	@echo "make inspector                 a parrot with every panel of the editor"
	@echo "make tour                      its pictures in docs/inspector_tour, by a mouse in a virtual window"
	@echo "make test                      format, lints, tests, documentation, shaders"
	@echo "make gallery                   all pictures of the README"
	@echo "make charts | bench | docs     docs/charts; benchmarks; API documentation"
	@echo "make birds | feathers | tables bake the assets anew"

setup:
	@./scripts/setup.sh

parrot eagle fur chick: setup
	$(CARGO) run --example $@ -- $(ARGS)

single: setup
	$(CARGO) run --example single_feather -- $(ARGS)

inspector: setup
	$(CARGO) run --features inspector,extract --example inspector -- $(ARGS)

tour:
	@./scripts/setup.sh pictures window
	$(CARGO) build --features inspector,extract --example inspector
	./scripts/tour.sh 1
	./scripts/tour.sh 2

test: setup
	$(CARGO) fmt --check
	@if $(CARGO) tree --all-features -d 2>/dev/null | grep -E '^(egui|wgpu|naga|bevy) v'; then echo "more than one egui, wgpu, naga or bevy"; exit 1; fi
	./scripts/one_egui.sh
	$(CARGO) clippy --all-targets -- -D warnings
	$(CARGO) clippy --all-targets --all-features -- -D warnings
	$(CARGO) test --all-features
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --no-deps --lib --examples --all-features

gallery:
	@./scripts/setup.sh pictures
	$(CARGO) build --examples --all-features
	./scripts/gallery.sh

charts: setup
	$(CARGO) run --example scattering_charts
	$(CARGO) run --example transparency_chart
	$(CARGO) run --config 'profile.dev.opt-level=3' --example query_charts
	$(CARGO) run --example parrot -- --headless --size 240x135 --time 0 --camera closeup --compare docs/charts/parrot_closeup.json
	$(CARGO) run --example parrot -- --headless --size 1280x720 --time 0 --camera hero --transparency hashed --compare docs/charts/parrot_hero.json
	$(CARGO) run --config 'profile.dev.opt-level=3' --features extract --example extract_charts
	$(CARGO) run --config 'profile.dev.opt-level=3' --example down_charts
	$(CARGO) run --config 'profile.dev.opt-level=3' --example fur_charts

bench: setup
	$(CARGO) bench --profile dev --config 'profile.dev.opt-level=3'

docs: setup
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --no-deps --lib --examples --all-features

birds:
	$(CARGO) run --example bake_birds

feathers:
	$(CARGO) run --example bake_feathers

tables:
	$(CARGO) run --example bake_tables
