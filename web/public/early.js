// What the first answer of the daemon can do before the dashboard has come: look as chosen, and stop.
(() => {
	const page = document.documentElement;
	page.dataset.theme = localStorage.getItem('jointbench.theme') ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
	const button = document.getElementById('early-stop');
	const said = document.getElementById('early-said');
	const token = sessionStorage.getItem('jointbench.token');
	const headers = token ? { authorization: `Bearer ${token}` } : {};
	const ask = async (path, method) => {
		const answer = await fetch(`/api/v1/bench${path}`, { method, headers });
		if (!answer.ok) throw new Error(answer.status === 401 ? 'the daemon wants a token' : `the daemon answers ${answer.status}`);
		return answer.json();
	};
	button.addEventListener('click', async () => {
		said.textContent = 'Stopping';
		try {
			const benches = await ask('', 'GET');
			await Promise.all(benches.map(({ name }) => ask(`/${encodeURIComponent(name)}/stop`, 'POST')));
			said.textContent = `✓ Stopped: ${benches.map(({ name }) => name).join(', ')}`;
		} catch (failure) {
			said.textContent = `USE THE HARDWARE STOP: ${failure.message}`;
		}
	});
})();
