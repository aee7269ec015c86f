# Every target installs what it needs (`setup`). All share one build profile, so that Bevy is compiled once.
CARGO ?= cargo
ARGS ?=

.PHONY: help minimal parrot eagle owl pigeon flock wind single fur chick inspector tour test test-long golden gallery charts bench gpu-cost judge blender docs birds feathers tables setup setup-tests

help:
	@echo "Examples: a window, or off screen without a display; ARGS='--camera closeup' passes options, ARGS=--help lists them."
	@echo "  make parrot | eagle | owl        two parrots; a golden eagle; a barn owl"
	@echo "  make flock                       twenty equal parrots"
	@echo "  make pigeon                      a rock dove's neck, which changes between green and purple as it turns"
	@echo "  make wind                        a parrot in changing wind, ruffling its feathers"
	@echo "  make single                      one feather"
	@echo "  make fur | chick                 fur on a bent cylinder; a young bird in its down"
	@echo "  make inspector                   a parrot with the editor's panels"
	@echo "  make minimal                     the smallest app (needs a display)"
	@echo "Checks:"
	@echo "  make test                        format, lints, tests, documentation, shaders"
	@echo "  make test-long                   the tests that take minutes: whole ranges, of which the usual ones take samples"
	@echo "  make golden                      writes the tests' reference pictures anew, where a change is meant"
	@echo "  make bench                       benchmarks of the evaluators"
	@echo "  make gpu-cost                    what a GPU's compiler makes of every pipeline, without a GPU"
	@echo "  make judge                       light of a vane by Mitsuba 3, in a Python environment of its own"
	@echo "  make blender                     a bird from Blender to feathers and back, in a Python environment of its own"
	@echo "Documentation:"
	@echo "  make docs                        API documentation"
	@echo "  make gallery                     every picture of the README, into docs"
	@echo "  make charts                      accuracy against cost, into docs/charts"
	@echo "  make tour                        pictures of the inspector, driven by a mouse in a virtual window"
	@echo "Assets:"
	@echo "  make birds | feathers | tables   regenerate the assets from their programs"

setup:
	@./scripts/setup.sh

setup-tests:
	@./scripts/setup.sh tests

parrot eagle owl pigeon flock wind fur chick: setup
	$(CARGO) run --example $@ -- $(ARGS)

minimal: setup
	$(CARGO) run --example $@

single: setup
	$(CARGO) run --example single_feather -- $(ARGS)

inspector: setup
	$(CARGO) run --features inspector,photo --example inspector -- $(ARGS)

tour:
	@./scripts/setup.sh pictures window
	$(CARGO) build --features inspector,photo --example inspector
	./scripts/tour.sh 1
	./scripts/tour.sh 2

test: setup-tests
	$(CARGO) fmt --all --check
	@if $(CARGO) tree --all-features -d 2>/dev/null | grep -E '^(egui|wgpu|naga|bevy) v'; then echo "more than one egui, wgpu, naga or bevy"; exit 1; fi
	./scripts/one_egui.sh
	$(CARGO) clippy --workspace --all-targets --all-features -- -D warnings
	$(CARGO) test --workspace --all-features --lib --test "*"
	$(CARGO) test --workspace --all-features --doc
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --lib --examples --all-features

# Left out: a gap that the limits name.
test-long: setup-tests
	$(CARGO) test --workspace --all-features --test "*" -- --ignored --skip near_light_from_behind

golden: setup-tests
	PLUMAGE_GOLDEN=write $(CARGO) test --workspace --all-features --test view --test undercoat -- golden:: render::

gallery:
	@./scripts/setup.sh pictures
	$(CARGO) build --examples --features inspector,photo
	./scripts/gallery.sh

charts: setup-tests
	$(CARGO) run -p plumage_tools --bin scattering_charts
	$(CARGO) run -p plumage_tools --bin transparency_chart
	$(CARGO) run --config 'profile.dev.opt-level=3' -p plumage_tools --bin iridescence_charts
	$(CARGO) run --config 'profile.dev.opt-level=3' -p plumage_tools --bin query_charts
	$(CARGO) run --features comparison --example parrot -- --headless --scene studio --size 240x135 --time 0 --camera closeup --compare docs/charts/parrot_closeup.json
	$(CARGO) run --features comparison --example parrot -- --headless --scene studio --size 1280x720 --time 0 --camera hero --transparency hashed --compare docs/charts/parrot_hero.json
	mkdir -p target/charts
	$(CARGO) run --example parrot -- --headless --scene studio --size 480x270 --time 0 --light-cost target/charts/light_budget.csv
	$(CARGO) run --example parrot -- --headless --scene studio --size 240x135 --time 0 --transparency hashed --cost-table target/charts/cost.csv
	$(CARGO) run -p plumage_tools --bin cost_charts -- target/charts
	$(CARGO) run --config 'profile.dev.opt-level=3' -p plumage_tools --bin photo_charts
	$(CARGO) run --config 'profile.dev.opt-level=3' -p plumage_tools --bin undercoat_charts
	$(CARGO) run --config 'profile.dev.opt-level=3' -p plumage_tools --bin fur_charts

# Needs python3 with venv, and LLVM 17 or later (libllvm19 of Debian); DRJIT_LIBLLVM_PATH names it where it is not found.
JUDGED = crates/plumage_reference/data/judged_vanes.csv
judge: setup-tests
	python3 -m venv judge/.venv
	judge/.venv/bin/pip install --quiet --requirement judge/requirements.txt
	DRJIT_LIBLLVM_PATH="$${DRJIT_LIBLLVM_PATH:-$$(ls /usr/lib/*/libLLVM-1[7-9].so /usr/lib/*/libLLVM.so.* 2>/dev/null | head -1)}" \
		judge/.venv/bin/python judge/judge.py $(JUDGED) $(ARGS)
	$(CARGO) run --config 'profile.dev.opt-level=3' -p plumage_tools --bin vane_judge -- $(JUDGED)

# Needs python3 (3.11) with venv; with npm the file baked goes through Khronos' validator, too.
blender: setup
	CARGO="$(CARGO)" ./scripts/blender.sh

bench: setup-tests
	$(CARGO) bench -p plumage_benches --profile dev --config 'profile.dev.opt-level=3'

gpu-cost:
	@./scripts/setup.sh radeon tests
	$(CARGO) run -p plumage_tools --bin gpu_cost -- --save $(ARGS)

docs: setup
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --lib --examples --all-features

birds:
	$(CARGO) run -p plumage_tools --bin bake_birds

feathers:
	$(CARGO) run -p plumage_tools --bin bake_feathers

tables:
	$(CARGO) run -p plumage_tools --bin bake_tables
