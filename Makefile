# The project's commands. `make study` and `make test` do all the set-up on a machine with Rust.

CARGO ?= cargo
JOBS ?= $(shell nproc 2>/dev/null || echo 2)
SNOWLAB = $(CARGO) run --locked --release --quiet --bin snowlab --

.PHONY: help study pilot full quick render animate verify test check mutants bench report clean

help: ## list the targets
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

# `run` says by 3 that a case stopped, which the report shows and `check` fails for.
study: ## run the placement comparison; tables, figures and report go to results/placement
	$(SNOWLAB) run studies/placement.toml --jobs $(JOBS) || [ $$? -eq 3 ]
	$(SNOWLAB) report studies/placement.toml
	$(SNOWLAB) check studies/placement.toml

pilot: ## run the pilot that chose the study's speed; its table goes to results/pilot
	$(SNOWLAB) run studies/pilot.toml --jobs $(JOBS) || [ $$? -eq 3 ]
	$(SNOWLAB) report studies/pilot.toml

# What docs/findings.md is made of, beside the comparison itself.
OTHERS = pilot replicates damping stencil stencil3d knob knob-validation tradeoff tradeoff-fragments wall3d

full: ## run every study of docs/findings.md in full, under 10 h on two cores, and write that page; stopped, it goes on where it was
	for study in $(OTHERS) placement "placement --profile full"; do \
		name=$${study%% *}; profile=$${study#$$name}; \
		$(SNOWLAB) run studies/$$name.toml$$profile --jobs $(JOBS) || [ $$? -eq 3 ] || exit; \
		$(SNOWLAB) report studies/$$name.toml$$profile || exit; \
	done
	$(SNOWLAB) design studies/knob.toml --score studies/knob-validation.toml
	$(SNOWLAB) tradeoff studies/tradeoff.toml
	$(SNOWLAB) report studies/tradeoff.toml
	$(SNOWLAB) page docs/sources/findings.md.jinja -o docs/findings.md

# The validation is of the full response only.
quick: ## run short forms of the same, in minutes; tables, figures and reports go to target/quick
	for study in $(filter-out knob-validation,$(OTHERS)) placement; do \
		$(SNOWLAB) run studies/$$study.toml --profile quick --jobs $(JOBS) --out target/quick || [ $$? -eq 3 ] || exit; \
		$(SNOWLAB) report studies/$$study.toml --profile quick --out target/quick || exit; \
	done

# Mitsuba 3 is installed into a folder of the build.
MITSUBA = target/mitsuba/bin/python

$(MITSUBA):
	python3 -m venv target/mitsuba && $@ -m pip install --quiet mitsuba==3.9.1

render: $(MITSUBA) ## draw the balls at the wall in space, before, at and after the impact; pictures go to results/wall3d/pictures
	$(SNOWLAB) run studies/wall3d.toml --profile film --jobs $(JOBS) || [ $$? -eq 3 ]
	$(SNOWLAB) render studies/wall3d.toml --profile film --arms random,spheres --frame 0,16,40 --preset still \
		--python $(MITSUBA) --out results/wall3d/pictures

animate: ## draw PS17's four snowballs and the balls at the wall as GIF, into results/placement/figures and results/wall3d/figures
	$(SNOWLAB) run studies/placement.toml --profile film --jobs $(JOBS) || [ $$? -eq 3 ]
	$(SNOWLAB) animate studies/placement.toml --profile film --output results/placement/figures/snowballs.gif
	$(SNOWLAB) run studies/wall3d.toml --profile film --jobs $(JOBS) || [ $$? -eq 3 ]
	$(SNOWLAB) animate studies/wall3d.toml --profile film --every 5 --width 480 --rate 8 --output results/wall3d/figures/snowballs.gif

verify: ## show what the solver has been shown to do; docs/verification.md, tables and figures in results/verify
	$(SNOWLAB) verify --page docs/verification.md

test: ## build and run all tests
	$(CARGO) test --locked --release --workspace

# Instructions are counted where valgrind is installed, by 77 the script says that it is not.
check: ## formatting, lints, docs, the study's smoke profile within its ranges, the verification's short form, the same binary from another folder, instruction counts
	$(CARGO) fmt --all --check
	$(CARGO) clippy --locked --release --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --locked --release --workspace --no-deps
	$(SNOWLAB) run studies/placement.toml --profile smoke --jobs $(JOBS) --out target/smoke || [ $$? -eq 3 ]
	$(SNOWLAB) report studies/placement.toml --profile smoke --out target/smoke
	$(SNOWLAB) check studies/placement.toml --profile smoke --out target/smoke
	$(SNOWLAB) verify --quick --out target/verify --page target/verify/page.md
	tests/reproducible/run
	tests/instructions/run || [ $$? -eq 77 ]

mutants: ## put known bugs into copies of the code and expect the tests to fail
	tests/mutants/run

bench: ## time a step of the solver
	$(CARGO) bench --locked --workspace

report: ## write the reports of the studies that have been run, and results/index.html over all of them
	@for target in study:placement $(OTHERS:%=full:%); do \
		study=$${target#*:}; \
		plan=$$($(SNOWLAB) plan --no-trials studies/$$study.toml) || exit; \
		if echo "$$plan" | grep -q '^finished'; then \
			$(SNOWLAB) report studies/$$study.toml || exit; \
		else \
			echo "$$study has not been run; \`make $${target%:*}\` runs it"; \
		fi; \
	done
	@$(SNOWLAB) index studies/*.toml

clean: ## delete the cases of all studies (tables, figures and reports stay) and the build
	rm -rf results/*/cases results/*/*/cases
	$(CARGO) clean
