# `make` lists the targets. Linux and macOS; on Windows run the same commands by hand.

PYTHON ?= python3
PHOTO ?= examples/coffee.png
TRAINING_IMAGES ?= 10000
SAMPLES ?= $(or $(FLEXDEPTH_SAMPLES),../shared/data)

BIN := .venv/bin
ALONE := $(BIN)/python -m pip --python .wheel-venv/bin/python
DEMO := predict $(PHOTO) --preview --points glb --overwrite

.DEFAULT_GOAL := help
.PHONY: help demo test wheel-test lint unit model bench-quality bench-certainty bench-stability \
	bench-scoring bench-speed bench-ego bench-solve clean

help:  ## list the targets
	@awk -F ':.*  ## ' '/^[a-z-]+:.*  ## / {printf "%-15s %s\n", $$1, $$2}' Makefile

demo: .venv/base.stamp  ## install the light runtime and write the depth of a photo into depth/
	$(BIN)/flexdepth $(DEMO) -o depth

test: wheel-test lint unit  ## check everything, from the wheel to the last test

wheel-test: .venv/base.stamp  ## build the wheel, install it alone, run the demo there, measure it
	rm -rf .wheel-venv build/wheel
	$(PYTHON) -m venv --without-pip .wheel-venv
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir build/wheel .
	$(ALONE) install --quiet -c constraints.txt build/wheel/*.whl
	$(ALONE) check
	.wheel-venv/bin/flexdepth $(DEMO) -o build/wheel/depth
	.wheel-venv/bin/python .ci/light_install.py

lint: .venv/full.stamp  ## ruff (format and rules), mypy --strict, the layers
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy --strict
	$(BIN)/lint-imports

unit: .venv/full.stamp  ## the tests
	$(BIN)/python -m pytest

model: .venv/full.stamp  ## make weights as the bundled ones are made, from nothing (hours; an interrupted run goes on)
	$(BIN)/flexdepth synth --seed 0 --count $(TRAINING_IMAGES) -o renders/train
	$(BIN)/flexdepth synth --seed 1 --count 160 -o renders/heldout
	$(BIN)/flexdepth train compact -o runs/compact
	$(BIN)/flexdepth train compact-large -o runs/compact-large
	$(BIN)/flexdepth synth --seed 5 --count 3000 -o renders/calibration
	$(BIN)/flexdepth train compact-spread -o runs/compact-spread
	$(BIN)/flexdepth export runs/compact-spread/latest.safetensors \
		-o src/flexdepth/runtime/assets/compact.onnx \
		--source "flexdepth train compact, -large, -spread; $(TRAINING_IMAGES) images of seed 0"

bench-quality: .venv/full.stamp  ## error on real pictures with measured depth (SAMPLES=DIR MODELS="compact hub:...")
	$(BIN)/python benchmarks/quality.py --samples $(SAMPLES) $(foreach model,$(MODELS),--model $(model))

bench-certainty: .venv/full.stamp  ## whether the model knows how far off it is (SAMPLES=DIR)
	$(BIN)/python benchmarks/certainty.py --samples $(SAMPLES)

bench-stability: .venv/full.stamp  ## whether depth stays when the picture hardly changes, and is flat (SAMPLES=DIR)
	$(BIN)/python benchmarks/stability.py --photos $(SAMPLES)/wild_depth_anything_v2

bench-scoring: .venv/full.stamp  ## time and memory of scoring 697 predictions
	$(BIN)/python benchmarks/scoring.py

bench-speed: .venv/full.stamp  ## time and memory
	$(BIN)/python benchmarks/speed.py

bench-ego: .venv/full.stamp  ## the camera's own motion on real pairs (SAMPLES=DIR)
	$(BIN)/python benchmarks/ego_motion.py --samples $(SAMPLES)

bench-solve: .venv/full.stamp  ## depth from two frames of a moving world, all methods in one table
	$(BIN)/python benchmarks/solve/two_frames.py
	$(BIN)/python benchmarks/solve/speed_of_solving.py
	$(BIN)/python benchmarks/solve/real.py --samples $(SAMPLES)

clean:  ## remove the environments, the builds and the caches; depth/ and runs/ stay
	rm -rf .venv .wheel-venv build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis
	rm -rf .import_linter_cache

# The pinned versions first; where this Python has no wheels of them, the newest that fit.
.venv/base.stamp: pyproject.toml constraints.txt | .python
	@echo "installing flexdepth into .venv (about 200 MB to download, once)"
	test -x $(BIN)/pip || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --only-binary :all: -c constraints.txt -e . \
		|| $(BIN)/python -m pip install --quiet -e .
	@touch $@

.venv/full.stamp: .venv/base.stamp
	@echo "installing torch and the tools into .venv (on Linux several GB, once)"
	$(BIN)/python -m pip install --quiet -c constraints.txt -e '.[torch,dev]'
	@touch $@

.PHONY: .python
.python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
		echo "flexdepth needs Python 3.11 or newer, but $(PYTHON) is not:" \
			"make $(or $(MAKECMDGOALS),demo) PYTHON=python3.12" >&2; exit 1; }
