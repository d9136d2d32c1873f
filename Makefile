# `make help` says what there is. Everything is made inside this tree: .venv, build and out.
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := help

bin := .venv/bin
native := CMakeLists.txt pyproject.toml tools/setup.sh $(shell find src python/bindings -type f)
cpp := $(shell find src python/bindings tests/cpp -name '*.cpp' -o -name '*.h')
jobs := $(shell nproc)

.PHONY: help demo test test-cpp test-python test-slow lint lint-python lint-types lint-format lint-cpp format stub asan tsan clean
.DELETE_ON_ERROR:

help: ## Say what there is to make
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

# A stamp says that .venv holds a lumel built from the newest native sources; Python files are used where they lie.
.venv/run.stamp: $(native)
	tools/setup.sh
	@touch $@

.venv/dev.stamp: $(native)
	tools/setup.sh dev
	@touch .venv/run.stamp $@

demo: .venv/run.stamp ## Install what is missing, build, render the demo scene into out/demo
	$(bin)/lumel demo -o out/demo

test: test-cpp test-python ## Install what is missing, build, run all quick tests (C++ and Python)

test-cpp: .venv/dev.stamp ## The tests of the C++ core
	cmake --preset release $(CMAKE_FLAGS)
	cmake --build --preset release
	ctest --preset release

test-python: .venv/dev.stamp ## The tests of the Python package, the README's among them
	$(bin)/pytest $(PYTEST_FLAGS)

test-slow: .venv/dev.stamp ## The proofs that take minutes
	$(bin)/pytest -m slow $(PYTEST_FLAGS)

lint: lint-python lint-types lint-format lint-cpp ## Style and types of all sources; `make -k lint` goes on after a finding

lint-python: .venv/dev.stamp
	$(bin)/ruff check .
	$(bin)/ruff format --check .

lint-types: .venv/dev.stamp
	$(bin)/mypy

lint-format: .venv/dev.stamp
	$(bin)/clang-format --dry-run -Werror $(cpp)

lint-cpp: .venv/dev.stamp
	cmake --preset release $(CMAKE_FLAGS) >/dev/null
	printf '%s\n' $(filter src/%.cpp,$(cpp)) | xargs -P $(jobs) -n 1 $(bin)/clang-tidy -p build/release --quiet --warnings-as-errors='*' --extra-arg=-Werror \
	    2>&1 | { grep -v ' warnings\? generated' || true; }  # those of other people's headers

format: .venv/dev.stamp ## Rewrite all sources in the house style
	$(bin)/ruff check --fix .
	$(bin)/ruff format .
	$(bin)/clang-format -i $(cpp)

stub: .venv/dev.stamp ## Write anew what type checkers know of the native module
	$(bin)/python -m nanobind.stubgen -q -m lumel._core -o python/lumel/_core.pyi

asan: .venv/dev.stamp ## The C++ tests under the address and undefined behaviour sanitizers
	cmake --preset asan && cmake --build --preset asan && ctest --preset asan

tsan: .venv/dev.stamp ## The C++ tests under the thread sanitizer
	tools/tsan.sh

clean: ## Remove all that was built, .venv included
	rm -rf build .venv out dist .pytest_cache .mypy_cache .ruff_cache
	find . -name __pycache__ -prune -exec rm -rf {} +
