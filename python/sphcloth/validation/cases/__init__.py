"""The cases: one package each, found by themselves; see ``docs/validation.md`` to add one."""
