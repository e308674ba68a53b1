"""The study of every optimizer under control: fixed sizes, rules, blind schedules and policies for each."""
