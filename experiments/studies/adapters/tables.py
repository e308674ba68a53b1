"""The document that shows the suite of adapted algorithms."""

from experiments.tables.document import document_of_suite

DOCUMENTS = {"adapters": document_of_suite("docs/adapters.md", "adapters")}
