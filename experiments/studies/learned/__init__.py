"""The study of learned controllers, shown in docs/study.md."""
