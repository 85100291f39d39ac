# Two commands on a fresh machine:  make collect TASK=click_bell EPISODES=2   and   make test
TASK ?= click_bell
EPISODES ?= 2
OUT ?= data
PYTEST ?=
BIN := .venv/bin

.PHONY: setup setup-test setup-dev setup-docs collect test test-all check format ci smoke reprove remake \
        wheel release bench tables pictures docs clean

setup:            ## environment, Vulkan driver, assets (quick when nothing is to do)
	@scripts/setup.sh

setup-test:       ## the same, and what the tests need
	@scripts/setup.sh test

setup-dev:        ## the same, and ruff and pyright
	@scripts/setup.sh dev

setup-docs:       ## the same as for collecting, and what builds the site
	@scripts/setup.sh docs

collect: setup    ## EPISODES verified episodes of TASK in OUT
	$(BIN)/rtphys collect --task $(TASK) --episodes $(EPISODES) --out $(OUT)

# A test that hangs, in C as well, fails after ten minutes with its stack; the others go on.
OR_FAIL := -o faulthandler_timeout=600 -o faulthandler_exit_on_timeout=true
test: setup-test  ## all tests but the slow ones: minutes
	$(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow" $(OR_FAIL) $(PYTEST)

test-all: setup-test  ## all tests
	$(BIN)/python -m pytest -n 2 --dist worksteal $(PYTEST)

# Without that variable pyright asks PyPI for a newer version of itself in every run.
check: setup-dev  ## format, lint, types
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	PYRIGHT_PYTHON_IGNORE_WARNINGS=1 $(BIN)/pyright

format: setup-dev ## let ruff fix what it can
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

wheel: setup-test ## build the wheel into dist/ and try it in a clean environment
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .
	$(BIN)/python -m pytest -m slow tests/test_wheel.py

release: setup-test ## wheel and sdist of a finished version in dist/, tried in a clean environment
	$(BIN)/python scripts/release.py
	$(BIN)/python -m pytest -m slow tests/test_wheel.py

smoke: setup      ## collect manifests/smoke.yaml into build/smoke, and verify it
	rm -rf build/smoke
	$(BIN)/rtphys collect --manifest manifests/smoke.yaml --out build/smoke
	$(BIN)/rtphys verify build/smoke --deep --reproduce 1

# Two more tasks every day of the year; a list that does not hold ends it.
SHARE = ls tasks | sed -n 's/^\([a-z].*\)\.py$$/\1/p' | awk "NR % 25 == $$(date +%-j) % 25" | paste -sd,
reprove: setup    ## solve one instance of a rotating share of the certified lists again
	$(BIN)/rtphys certify --reprove 1 --task "$$($(SHARE))" --protocol "$$(ls manifests/benchmark_v3 | sed s/.jsonl// | paste -sd,)" \
	    --out manifests/benchmark_v3

# Another task every week of the year.
OF_WEEK = import datetime, json; \
    tasks = sorted(json.load(open("manifests/training_v1.digests.json"))["tasks"]); \
    print(tasks[datetime.date.today().isocalendar().week % len(tasks)])
remake: setup     ## make the first two episodes of a task of Training Set v1 again, and compare them
	rm -rf build/remade
	$(BIN)/rtphys collect "$$($(BIN)/python -c '$(OF_WEEK)')" --episodes 2 --out build/remade
	$(BIN)/rtphys verify build/remade --expect training_v1

# pyright has one thread, so two parts run beside each other. The tests run last, and also when an
# earlier part has failed: pytest's summary ends the output.
ci: setup-dev     ## what continuous integration runs: check, wheel, smoke, reprove, test
	@$(MAKE) --no-print-directory --keep-going --jobs=2 --output-sync check wheel smoke reprove; \
	    parts=$$?; $(MAKE) --no-print-directory --jobs=1 test && exit $$parts

bench: setup      ## CPU cost by phase of every task, and of an export, in build/bench.json
	@mkdir -p build
	$(BIN)/rtphys bench --json > build/bench.json
	$(BIN)/python benchmarks/export.py

tables: setup     ## write the generated tables into the documents
	$(BIN)/python scripts/tables.py

pictures: setup   ## README's pictures: every task solved once, four in motion
	$(BIN)/python scripts/pictures.py contact_sheet moving

docs: setup-docs  ## the documentation site in build/site
	$(BIN)/python scripts/site.py build/site_pages
	$(BIN)/python -m mkdocs build --strict --quiet
	@echo "build/site/index.html"

clean:            ## remove what was built, not what was collected
	rm -rf .venv dist build .pytest_cache .ruff_cache .hypothesis
	find src tests tasks -name __pycache__ -type d -prune -exec rm -rf {} +
