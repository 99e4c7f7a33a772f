"""The cases, one package each; ``docs/evidence/validation.md`` says how to add one."""
