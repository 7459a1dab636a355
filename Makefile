# Two commands: `make run` sets up and does the main job, `make test` sets up and runs all tests.

# Software Vulkan unless the person chose otherwise, so that tests draw the same everywhere.
export WGPU_BACKEND ?= vulkan

.PHONY: run test bench screenshots figures help

help:
	@echo "make run          set up, build in release, open the explorer (without a display: write figures to out/)"
	@echo "make test         set up, then format, lint, documentation and all tests"
	@echo "make bench        benchmarks (release, some minutes)"
	@echo "make screenshots  draw screenshots/ again in a real window"
	@echo "make figures      write screenshots/figures again: the gallery of the papers' figures"

# With a display the explorer opens; without one the same scenes are stepped headless, and the GUI's
# crates are not built at all.
run:
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then \
		.ci/setup window && cargo build --release --locked && exec target/release/cullscope explore; \
	else \
		.ci/setup build && cargo build --release --locked --no-default-features && exec .ci/headless target/release/cullscope out; \
	fi

test:
	.ci/setup test
	cargo fmt --check
	cargo clippy --locked --all-targets --features ui-tests -- -D warnings
	cargo check --locked --no-default-features
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps --lib
	XDG_RUNTIME_DIR=$${XDG_RUNTIME_DIR:-$$(mktemp -d)} cargo test --locked --features ui-tests

bench:
	.ci/setup build
	cargo bench --locked --no-default-features

screenshots:
	.ci/setup test
	cargo build --release --locked
	.ci/screenshots target/release/cullscope screenshots

figures:
	.ci/setup build
	cargo build --release --locked --no-default-features
	target/release/cullscope figure --gallery screenshots/figures
