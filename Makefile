# `make demo` and `make test` are all a newcomer needs; both make their environment first.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/ready

DATA   ?=
RUNS   ?= 1000000
LOWEST := 'pytest>=8.2' 'pytest-timeout>=2.3.1' 'hypothesis>=6.100' 'libigl>=2.6' 'pygeodesic>=0.1.9'
PROCESSES ?= 2

.PHONY: demo test lint types artifact-types tests coverage benchmarks faults fuzz accuracy lowest audit licences sbom wheel clean

demo: $(READY)
	$(BIN)/kinetree demo --output demo-output

test: lint types tests

lint: $(READY)
	$(BIN)/ruff check .

types: $(READY)
	$(BIN)/mypy

# what the artifact of a task's name is to a type checker; after a task was added or renamed
artifact-types: $(READY)
	$(BIN)/python .ci/artifact_of_task.py

# files go to the processes in the order in which they are collected: those that take longest first;
# one thread of BLAS in each, since the processes fill the cores
tests: $(READY)
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n $(PROCESSES) --dist loadfile --no-loadscope-reorder

# half as much processor time again, so it stands apart
coverage: $(READY)
	$(BIN)/pytest -n $(PROCESSES) --dist loadfile --no-loadscope-reorder --cov --cov-report=term

# without those that have a command of their own, need data or many hours, and modules that others import
APART := accuracy alignment arap contacts damage faults flaky_service forked fuzz generated_truth joint_errors names rigged robustness \
	scheduled_run sensitivity shaken_alignment silhouettes spoilt stability turning

benchmarks: $(READY)
	for file in $(filter-out $(APART:%=benchmarks/%.py),$(wildcard benchmarks/*.py)); do $(BIN)/python $$file || exit 1; done
	$(BIN)/python benchmarks/alignment.py --generated

# runs whose workers, scheduler, store or own process are killed or taken away; an hour, and root for all of its cells
faults: $(READY)
	$(BIN)/python benchmarks/faults.py

# a million executions over all parsers, guided by coverage; half an hour
fuzz: $(READY)
	$(BIN)/python -m pip install --quiet 'atheris>=3.0'
	$(BIN)/python benchmarks/fuzz.py --runs $(RUNS) --work .fuzz

# every sequence with a known skeleton in the folder DATA, generated ones too, in one table
accuracy: $(READY)
	OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python benchmarks/accuracy.py $(if $(DATA),--data $(DATA)) $(if $(SEEDS),--seeds $(SEEDS)) --markdown

# the oldest versions that pyproject.toml permits, in an environment of their own; tests of what leans on other packages
lowest:
	$(PYTHON) -m venv .venv-lowest
	.venv-lowest/bin/python -m pip install --quiet uv
	.venv-lowest/bin/uv pip install --quiet --python .venv-lowest/bin/python --resolution lowest-direct . $(LOWEST)
	cd tests && OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 ../.venv-lowest/bin/python -P -m pytest -q -c ../pyproject.toml -W default \
		numerics/geometry numerics/input/test_formats.py numerics/input/test_source.py numerics/input/test_volumes.py \
		numerics/input/test_isosurface.py pipeline/test_store.py pipeline/test_groups.py pipeline/test_place.py

# known weaknesses of what is installed; fails where the advisories of PyPI are not served, too
audit: $(READY)
	$(BIN)/python -m pip install --quiet pip-audit
	$(BIN)/pip-audit --skip-editable --output .audit.txt || { cat .audit.txt; exit 1; }
	@left=$$(grep -c 'could not be audited' .audit.txt); test "$$left" = 0 || { grep 'could not be audited' .audit.txt; \
		echo "$$left packages were not audited: their advisories (pypi.org/pypi/NAME/VERSION/json) are not served here; run make audit where they are"; exit 1; }

# the licence of every package that a run needs
licences: $(READY)
	$(BIN)/python -m pip install --quiet pip-licenses
	$(BIN)/pip-licenses --format=markdown --order=license

# a bill of materials of the environment, CycloneDX 1.6
sbom: $(READY)
	$(BIN)/python -m pip install --quiet cyclonedx-bom
	$(BIN)/cyclonedx-py environment $(BIN)/python --pyproject pyproject.toml --output-reproducible --output-file sbom.json

# the same commit gives the same bytes
wheel: $(READY)
	SOURCE_DATE_EPOCH=$$(git log -1 --format=%ct) $(BIN)/python -m build --wheel

$(READY): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "kinetree needs Python 3.11 or newer; name it with make PYTHON=…"; exit 2; }
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet --editable '.[test]'
	$(BIN)/python -m compileall -q errors pipeline tasks schemas configs
	-PATH="$(CURDIR)/$(BIN):$$PATH" npm install --silent --no-save --no-audit --no-fund --prefix $(VENV) gltf-validator@2.0.0-dev.3.10
	touch $@

clean:
	rm -rf .fuzz .venv-lowest sbom.json .audit.txt $(VENV) demo-output build dist .coverage .mypy_cache .pytest_cache .ruff_cache *.egg-info
