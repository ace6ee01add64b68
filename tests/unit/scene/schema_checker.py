#!/usr/bin/env python3
"""Validates values by a JSON schema (draft 2020-12, by python3-jsonschema).

usage: schema_checker.py SCHEMA VALUES

Both files are JSON; VALUES is a list. Prints a list of as many lists: the violations of each value,
each with its place first.
"""

import json
import pathlib
import sys

import jsonschema

schema, values = (json.loads(pathlib.Path(name).read_text()) for name in sys.argv[1:])
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
print(
    json.dumps(
        [
            [f"{error.json_path}: {error.message}" for error in validator.iter_errors(value)]
            for value in values
        ]
    )
)
